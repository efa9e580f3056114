// Shows the page's anywidgets without a kernel: their saved state and their own
// module (`_esm`) are in the page. A widget tells by `model.kernelless`.
(() => {
  const STATE = 'script[type="application/vnd.jupyter.widget-state+json"]';
  const VIEW = 'script[type="application/vnd.jupyter.widget-view+json"]';

  // Put each base64 buffer back, as a DataView, at its path in the state.
  function decodeBuffers({ state, buffers = [] }) {
    for (const { path, data } of buffers) {
      const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
      const parent = path.slice(0, -1).reduce((node, key) => node[key], state);
      parent[path.at(-1)] = new DataView(bytes.buffer);
    }
    return state;
  }

  // The part of the anywidget model that works with no kernel behind it.
  function makeModel(state) {
    const listeners = new Map();
    const emit = (event, ...args) =>
      [...(listeners.get(event) ?? [])].forEach((callback) => callback(...args));
    return {
      kernelless: true,
      get: (name) => state[name],
      set(name, value) {
        const changes = typeof name === "string" ? { [name]: value } : name;
        const changed = Object.keys(changes).filter((key) => state[key] !== changes[key]);
        Object.assign(state, changes);
        changed.forEach((key) => emit(`change:${key}`, this, state[key]));
        if (changed.length) emit("change", this);
      },
      on(event, callback) {
        for (const name of event.split(/\s+/)) {
          if (!listeners.has(name)) listeners.set(name, new Set());
          listeners.get(name).add(callback);
        }
      },
      off(event, callback) {
        if (event == null) return listeners.clear();
        for (const name of event.split(/\s+/)) {
          if (callback) listeners.get(name)?.delete(callback);
          else listeners.delete(name);
        }
      },
      save_changes() {},
      send() {},
    };
  }

  // One model per id, shared by its views, as with a kernel.
  async function load(entry) {
    const state = decodeBuffers(entry);
    if (!state._esm) throw new Error("not an anywidget");
    if (state._css) {
      const style = document.createElement("style");
      style.textContent = state._css;
      document.head.append(style);
    }
    const url = URL.createObjectURL(new Blob([state._esm], { type: "text/javascript" }));
    try {
      const { default: exported } = await import(url);
      const widget = typeof exported === "function" ? await exported() : exported;
      const model = makeModel(state);
      await widget.initialize?.({ model });
      return { widget, model };
    } finally {
      URL.revokeObjectURL(url);
    }
  }

  // What a view shows, on its way; a failure is met where it is shown.
  function begin(script, entries, models) {
    const el = document.createElement("div");
    script.before(el);
    const loaded = (async () => {
      const id = JSON.parse(script.textContent).model_id;
      if (!entries[id]) throw new Error("its state is not in the page");
      models[id] ??= load(entries[id]);
      return models[id];
    })();
    loaded.catch(() => {});
    return { el, loaded };
  }

  async function show({ el, loaded }) {
    try {
      const { widget, model } = await loaded;
      await widget.render({ model, el });
      el.classList.add("ddlib-widget");
    } catch (error) {
      el.className = "ddlib-widget-error";
      el.setAttribute("role", "alert");
      el.textContent = `This interactive figure could not be shown: ${error.message}.`;
    }
  }

  async function mountAll() {
    let entries = {};
    try {
      entries = JSON.parse(document.querySelector(STATE).textContent).state;
    } catch {
      // each view below says that its state is missing
    }
    const models = {};
    const views = [...document.querySelectorAll(VIEW)].map((s) => begin(s, entries, models));
    for (const view of views) await show(view); // in order: the second of a kind is named so
    document.documentElement.dataset.widgets = "mounted";
  }

  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", mountAll);
  else mountAll();
})();
