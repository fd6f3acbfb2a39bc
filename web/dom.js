// SPDX-License-Identifier: Apache-2.0
// Small helpers for elements of the page.

export const $ = (id) => document.getElementById(id);

/// An element with attributes (onclick etc. are listeners; false and null leave one out) and children.
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) {
      element.addEventListener(name.slice(2), value);
    } else if (value !== false && value !== null && value !== undefined) {
      element.setAttribute(name, value === true ? "" : value);
    }
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/// Sets a text only where it differs: no layout, and nothing that a screen reader would say again.
export function setText(element, text) {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}

/// Takes a file that is chosen in a label's input, or dropped onto the label.
export function acceptFile(label, take) {
  const accept = (file) => file && take(file);
  label.querySelector("input").addEventListener("change", ({ target }) => {
    accept(target.files[0]);
    target.value = ""; // so that the same file can be chosen again
  });
  for (const type of ["dragover", "dragleave", "drop"]) {
    label.addEventListener(type, (event) => {
      event.preventDefault();
      label.classList.toggle("over", type === "dragover");
      accept(type === "drop" && event.dataTransfer.files[0]);
    });
  }
}

/// Makes the children of parent those of items, and keeps rows (and the focus in them) that stay.
export function syncList(parent, items, { key, create, update }) {
  const keys = items.map((item) => String(key(item)));
  const wanted = new Set(keys);
  const rows = new Map();
  for (const row of [...parent.children]) {
    if (wanted.has(row.dataset.key)) {
      rows.set(row.dataset.key, row);
    } else {
      row.remove();
    }
  }
  let next = parent.firstChild;
  items.forEach((item, i) => {
    const row = rows.get(keys[i]) ?? create(item);
    row.dataset.key = keys[i];
    update(row, item);
    if (row === next) {
      next = next.nextSibling;
    } else {
      parent.insertBefore(row, next);
    }
  });
}
