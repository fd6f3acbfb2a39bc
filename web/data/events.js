// SPDX-License-Identifier: Apache-2.0
// Server-sent events by fetch: EventSource can't send a token. Connects again by itself, and asks for what it missed.
import { openEvents } from "/web/data/api.js";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;
const SILENCE_MS = 40000; // the server says something every 15 s

/// Feeds text in any pieces, calls onEvent(name, data as text, id) for every event (WHATWG HTML, 9.2).
export class EventParser {
  constructor(onEvent) {
    this.onEvent = onEvent;
    this.rest = "";
  }

  feed(text) {
    const all = this.rest + text;
    let start = 0;
    for (let end = all.indexOf("\n\n"); end >= 0; end = all.indexOf("\n\n", start)) {
      this.parseBlock(all, start, end);
      start = end + 2;
    }
    this.rest = all.slice(start);
  }

  parseBlock(all, start, end) {
    let name = "message";
    let data = "";
    let id = "";
    for (const line of all.slice(start, end).split("\n")) {
      const colon = line.indexOf(":");
      const value = line.slice(line[colon + 1] === " " ? colon + 2 : colon + 1);
      if (line.startsWith("event:")) {
        name = value;
      } else if (line.startsWith("data:")) {
        data = value;
      } else if (line.startsWith("id:")) {
        id = value;
      }
    }
    if (data) {
      this.onEvent(name, data, id);
    }
  }
}

/// handlers: onOpen(), onEvent(name, object), onAway(error).
export class EventFeed {
  constructor(handlers) {
    this.handlers = handlers;
    this.lastId = "";
    this.wait = FIRST_WAIT_MS;
    this.run();
  }

  /// At once, with another token say.
  reconnect() {
    this.abort?.abort();
    clearTimeout(this.timer);
    this.wake?.();
  }

  async run() {
    for (;;) {
      try {
        await this.read();
        throw new Error("The server closed the connection.");
      } catch (error) {
        this.handlers.onAway(error);
      }
      await new Promise((resolve) => {
        this.wake = resolve;
        this.timer = setTimeout(resolve, this.wait);
      });
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT_MS);
    }
  }

  async read() {
    const abort = new AbortController();
    this.abort = abort;
    const response = await openEvents(this.lastId, abort.signal);
    this.wait = FIRST_WAIT_MS;
    await this.handlers.onOpen();
    const parser = new EventParser((name, data, id) => {
      this.lastId = id || this.lastId;
      this.handlers.onEvent(name, JSON.parse(data));
    });
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let watchdog;
    try {
      for (;;) {
        clearTimeout(watchdog);
        watchdog = setTimeout(() => abort.abort(), SILENCE_MS);
        const { value, done } = await reader.read();
        if (done) {
          return;
        }
        parser.feed(value);
      }
    } finally {
      clearTimeout(watchdog);
    }
  }
}
