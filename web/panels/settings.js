// SPDX-License-Identifier: Apache-2.0
// What a person chose: map, vehicle, filters in the URL; theme in the browser; token in the tab.
import { getToken, setToken } from "/web/data/api.js";
import { $, setText } from "/web/dom.js";

const DEFAULTS = { map: "", vehicle: "", state: "", search: "", order: "state", layer: "" };
const THEMES = ["system", "light", "dark"];
const THEME_KEY = "floorloc-theme";

export function readView() {
  const query = new URLSearchParams(location.search);
  return Object.fromEntries(Object.entries(DEFAULTS).map(([key, value]) => [key, query.get(key) ?? value]));
}

/// Keeps the view in the URL, so that it can be sent, and outlives a reload.
export function writeView(view) {
  const query = new URLSearchParams();
  for (const [key, value] of Object.entries(DEFAULTS)) {
    if (view[key] !== value) {
      query.set(key, view[key]);
    }
  }
  const text = query.size ? `?${query}` : "";
  if (text !== location.search) {
    history.replaceState(null, "", `${location.pathname}${text}`);
  }
}

function applyTheme(theme) {
  document.documentElement.dataset.theme = theme;
  setText($("theme"), `Theme: ${theme}`);
}

export function initTheme() {
  applyTheme(localStorage.getItem(THEME_KEY) ?? "system");
  $("theme").addEventListener("click", () => {
    const next = THEMES[(THEMES.indexOf(document.documentElement.dataset.theme) + 1) % THEMES.length];
    localStorage.setItem(THEME_KEY, next);
    applyTheme(next);
  });
}

/// The dialog for the token. onChange: it was set or removed. Who closed it without one is not asked again.
export class TokenDialog {
  constructor(onChange) {
    this.dialog = $("token-dialog");
    this.dialog.addEventListener("close", () => { this.declined = !getToken(); });
    $("token-open").addEventListener("click", () => this.open(""));
    $("token-remove").addEventListener("click", () => this.finish("", onChange));
    $("token-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.finish($("token-value").value.trim(), onChange);
    });
    $("token-cancel").addEventListener("click", () => this.dialog.close());
  }

  ask(why) {
    if (!this.declined) {
      this.open(why);
    }
  }

  open(why) {
    if (!this.dialog.open) {
      setText($("token-why"), why);
      $("token-value").value = "";
      $("token-remove").hidden = !getToken();
      this.dialog.showModal();
    }
  }

  finish(token, onChange) {
    setToken(token);
    this.dialog.close();
    this.declined = false;
    onChange();
  }
}
