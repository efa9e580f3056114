// The kernel behind a widget, if there is one.

const GONE = ["dead", "terminating", "restarting", "autorestarting"]; // states of a kernel

// The kernel behind a model: whether it works at something else, as JupyterLab alone can tell; send()
// returns false where the connection is closed; gone() is called when the kernel goes, as JupyterLab
// tells at once and elsewhere the next send.
export function kernelOf(model) {
  const known = () => model.widget_manager?.kernel;
  const signals = [known()?.statusChanged, known()?.disposed];
  let watching;
  const told = (_, status) => (status === undefined || GONE.includes(status)) && watching();
  return {
    busy: () => known()?.status === "busy",
    send(act) {
      try {
        act();
        return true;
      } catch {
        return false;
      }
    },
    watch(gone) {
      watching = gone;
      for (const signal of signals) signal?.connect(told);
    },
    leave() {
      for (const signal of signals) signal?.disconnect(told);
    },
  };
}
