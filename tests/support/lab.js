// What tests ask of an open JupyterLab; its notebook is `window.panel`.
window.lab = {
  // Nothing is awaited here: a promise on which no object of the page waits may be collected.
  show(path) {
    const app = window.jupyterapp;
    window.panel = null;
    window.opening = app.restored
      .then(() => app.commands.execute("docmanager:open", { path, factory: "Notebook" }))
      .then((panel) => panel.context.ready.then(() => { window.panel = panel; }));
  },

  async run(places) {
    const { panel } = window;
    const { commands } = window.jupyterapp;
    const { content } = panel;
    await panel.sessionContext.ready;
    while (panel.sessionContext.session?.kernel?.status !== "idle") {
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    if (places === null) return void commands.execute("notebook:run-all-cells");
    const codes = content.widgets.filter(({ model }) => model.type === "code");
    for (const place of places) {
      content.activeCellIndex = content.widgets.indexOf(codes[place]);
      content.deselectAll();
      await commands.execute("notebook:run-cell");
    }
  },

  // Every code cell to run has its prompt number, or one has failed.
  ran(places) {
    const codes = [...window.panel.content.model.cells].filter((cell) => cell.type === "code");
    const cells = places?.map((place) => codes[place]) ?? codes;
    const errors = cells.flatMap((cell) => cell.outputs.toJSON())
      .filter((output) => output.output_type === "error" || output.name === "stderr");
    const todo = cells.filter((cell) => cell.executionCount === null);
    return { todo: todo.length, errors: errors.map((e) => (e.evalue ?? e.text).slice(0, 500)) };
  },

  // Models of the widgets that cells have shown, in the order of the page.
  shown() {
    return [...window.panel.content.model.cells].filter((cell) => cell.type === "code")
      .flatMap((cell) => cell.outputs.toJSON())
      .map((output) => output.data?.["application/vnd.jupyter.widget-view+json"]?.model_id)
      .filter(Boolean);
  },

  async ask(code) {
    const kernel = window.panel.sessionContext.session.kernel;
    const future = kernel.requestExecute({ code, store_history: false });
    let text = "";
    future.onIOPub = ({ content }) => {
      text += content.text ?? content.traceback?.join("\n") ?? "";
    };
    await future.done;
    return text;
  },

  save: () => window.panel.context.save(),

  // Without a question whether to keep what was changed. The session ends first: what still
  // listens to a closed panel would look for its kernel. And not before a kernel that starts is
  // at rest: what it is asked then would never be answered.
  async close() {
    const { panel } = window;
    await panel.sessionContext.ready;
    const starts = () => ["unknown", "starting", "busy", "connecting"]
      .includes(panel.sessionContext.session?.kernel?.status);
    for (let calm = 0, k = 0; calm < 5 && k < 200; k++) {
      calm = starts() ? 0 : calm + 1;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    await panel.context.revert();
    await panel.sessionContext.shutdown();
    panel.close();
  },
};
