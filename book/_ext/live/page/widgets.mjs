// *Run this page*: shows the widgets that cells make. Each has its object in Python, in the worker,
// and a model here, as with a kernel: what either side sets, the other hears.

const bytesOf = (view) => new Uint8Array(view.buffer, view.byteOffset, view.byteLength);

// `post(message, buffers)` reaches the worker, `busy()` tells whether it runs a cell.
export function host(post, busy) {
  const models = new Map(); // by the widget's number in Python
  const flying = new Set(); // numbers of models whose last change Python has not taken over yet
  const styles = new Set();
  let alive = true;

  function modelOf(number, { esm, css }) {
    const state = {};
    const listeners = new Map();
    const gone = new Set();
    let pending = {};
    const emit = (event, ...given) =>
      [...(listeners.get(event) ?? [])].forEach((callback) => callback(...given));
    const put = (changes) => {
      const changed = Object.keys(changes).filter((name) => state[name] !== changes[name]);
      Object.assign(state, changes);
      changed.forEach((name) => emit(`change:${name}`, model, state[name]));
      if (changed.length) emit("change", model);
      return changed;
    };
    const signal = { connect: (f) => gone.add(f), disconnect: (f) => gone.delete(f) };
    const kernel = {
      get status() {
        return busy() ? "busy" : "idle";
      },
      disposed: signal,
    };
    const model = {
      widget_manager: { kernel },
      get: (name) => state[name],
      set(name, value) {
        const changes = typeof name === "string" ? { [name]: value } : name;
        for (const key of Object.keys(changes)) {
          if (state[key] !== changes[key]) pending[key] = changes[key];
        }
        put(changes);
      },
      on(events, callback) {
        for (const event of events.split(/\s+/)) {
          if (!listeners.has(event)) listeners.set(event, new Set());
          listeners.get(event).add(callback);
        }
      },
      off(events, callback) {
        if (events == null) return listeners.clear();
        for (const event of events.split(/\s+/)) {
          if (callback) listeners.get(event)?.delete(callback);
          else listeners.delete(event);
        }
      },
      save_changes() {
        if (!alive) throw new Error("Python is gone");
        if (!flying.has(number)) flush(); // else the newest values go when it is free
      },
      send(content) {
        if (!alive) throw new Error("Python is gone");
        flush();
        post({ number, content }, []);
      },
    };
    function flush() {
      const entries = Object.entries(pending);
      pending = {};
      if (!entries.length) return;
      flying.add(number);
      const binary = entries.filter(([, value]) => ArrayBuffer.isView(value));
      const others = entries.filter(([, value]) => !ArrayBuffer.isView(value));
      const names = binary.map(([name]) => name);
      const message = { number, state: Object.fromEntries(others), binary: names };
      post(message, binary.map(([, value]) => bytesOf(value)));
    }
    // What Python sets; where the page has set something newer, that stands.
    function take(changes) {
      put(Object.fromEntries(Object.entries(changes).filter(([name]) => !(name in pending))));
    }
    if (css && !styles.has(css)) {
      styles.add(css);
      const style = document.createElement("style");
      style.textContent = css;
      document.head.append(style);
    }
    const url = URL.createObjectURL(new Blob([esm], { type: "text/javascript" }));
    const script = import(url).then(async ({ default: made }) => {
      URL.revokeObjectURL(url);
      const widget = typeof made === "function" ? await made() : made;
      await widget.initialize?.({ model });
      return widget;
    });
    script.catch(() => {}); // it is told where the widget is shown
    return { model, script, take, flush, emit, gone, printed: "", views: new Map() };
  }

  // A message from Python.
  function heard({ number, made, state, binary, content, applied, said }, buffers = []) {
    if (made) models.set(number, modelOf(number, made));
    const entry = models.get(number);
    if (!entry) return;
    if (applied) {
      flying.delete(number);
      entry.flush();
      for (const { words } of entry.views.values()) words.textContent = entry.printed;
      entry.printed = "";
    } else if (said !== undefined) {
      entry.printed += said; // it is shown when all has come
    } else if (content !== undefined) entry.emit("msg:custom", content, buffers);
    else {
      const parts = binary.map((name, k) => [name, new DataView(buffers[k].buffer)]);
      entry.take({ ...state, ...Object.fromEntries(parts) });
    }
  }

  async function mount(number, place) {
    const entry = models.get(number);
    const [el, words] = [document.createElement("div"), document.createElement("pre")];
    words.className = "live-said";
    words.setAttribute("role", "status");
    place.append(el, words);
    const view = { words, stop: undefined };
    entry.views.set(place, view);
    try {
      const widget = await entry.script;
      if (!entry.views.has(place)) return; // the cell has run again meanwhile
      view.stop = await widget.render({ model: entry.model, el });
      el.classList.add("ddlib-widget");
    } catch (error) {
      el.className = "ddlib-widget-error";
      el.setAttribute("role", "alert");
      el.textContent = `This interactive figure could not be shown: ${error.message}.`;
    }
  }

  // Take down what is shown in an element.
  function drop(within) {
    for (const [number, entry] of models) {
      if (!entry.views.size) continue; // not shown yet
      for (const [place, { stop }] of entry.views) {
        if (!within.contains(place)) continue;
        entry.views.delete(place);
        stop?.();
      }
      if (entry.views.size) continue;
      models.delete(number);
      flying.delete(number);
      if (alive) post({ number, closed: true }, []);
    }
  }

  return {
    heard,
    mount,
    drop,
    flush: () => models.forEach(({ flush }) => flush()),
    // Python is ended: what is shown stays, by itself.
    end() {
      alive = false;
      models.forEach(({ gone }) => gone.forEach((callback) => callback()));
    },
  };
}
