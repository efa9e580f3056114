// *Run this page*: which cells follow from which, by the names that they share.
//
// A cell is { names: { reads, writes, perhaps, changes, imports, carries, alters, holds } } as
// names.py tells; once it ran, `altered` is what it did change in place, and `names.handled` those
// of its names that are figures to handle.
globalThis.follow = (() => {
  const has = (list, name) => list?.includes(name) ?? false;
  const gives = ({ names }, name) => has(names.writes, name) || has(names.perhaps, name);

  // For each cell: the cells above that each name comes from, and what it may change in place.
  function graph(cells) {
    const links = cells.map(({ names }) => ({
      from: new Map(),
      changes: new Set(),
      handled: new Set(names.handled),
    }));

    // Up to the last cell that binds the name whatever happens; the nearest comes first.
    function above(place, name) {
      const list = [];
      for (let k = place - 1; k >= 0; k--) {
        if (links[k].changes.has(name) || gives(cells[k], name)) list.push(k);
        if (has(cells[k].names.writes, name)) break;
      }
      return list;
    }

    // What functions in a name read or change when they are called, by the way they came.
    function inside(place, name, kind, seen = new Set()) {
      const key = `${place} ${name}`;
      if (seen.has(key)) return [];
      seen.add(key);
      const { names } = cells[place];
      const held = names.holds?.[name] ?? [];
      return [
        ...(names[kind]?.[name] ?? []),
        ...held.flatMap((n) => above(place, n).flatMap((k) => inside(k, n, kind, seen))),
      ];
    }

    cells.forEach(({ names, altered }, place) => {
      const { from, changes } = links[place];
      for (const name of altered ?? names.changes ?? []) changes.add(name);
      const todo = [...(names.reads ?? []), ...(altered ?? [])];
      for (let name; (name = todo.pop()) !== undefined; ) {
        if (from.has(name)) continue;
        const list = above(place, name);
        from.set(name, list);
        for (const k of list) {
          todo.push(...inside(k, name, "carries"));
          for (const n of inside(k, name, "alters")) {
            todo.push(n);
            if (!altered) changes.add(n);
          }
        }
      }
    });
    return links;
  }

  // Cells below that take a name from a cell: of all names that it gives, or of some.
  function readers(cells, links, place, only) {
    const wanted = (name) => !only || only.has(name);
    return cells.flatMap((_, k) => {
      if (k <= place) return [];
      const takes = [...links[k].from].some(([name, list]) => list.includes(place) && wanted(name));
      return takes ? [k] : [];
    });
  }

  // All cells that follow from some, by the code alone. `only` gives names of those that changed.
  function after(cells, links, places, only = new Map()) {
    const marked = new Set();
    const todo = [...places].map((k) => [k, only.get(k)]);
    for (let next; (next = todo.pop()); )
      for (const k of readers(cells, links, ...next)) {
        if (marked.has(k)) continue;
        marked.add(k);
        todo.push([k, undefined]);
      }
    return marked;
  }

  // A cell above that has to run again before a cell can: its object was changed in place since,
  // by that cell itself or by one below it. `turn` tells when cells ran in this worker. A figure
  // to handle stays as the reader left it.
  function spoiled(links, place, turn) {
    for (const [name, list] of links[place].from) {
      const maker = list.at(-1);
      if (maker === undefined || !turn[maker] || links[maker].handled.has(name)) continue;
      // a name that was made from itself may be the same object, or have it as a part
      const same = (k) => {
        let of = k;
        do of = links[of].from.get(name)?.at(-1) ?? -1;
        while (of > maker);
        return of === maker;
      };
      for (let k = place; k < links.length; k++)
        if (links[k].changes.has(name) && turn[k] > turn[maker] && same(k)) return { maker, name };
    }
    return undefined;
  }

  // Names of *Change this* whose lines differ, and those made from them; undefined: nobody knows.
  function renamed(before, now) {
    const [old, fresh] = [before.split("\n"), now.split("\n")];
    if (old.length !== fresh.length) return undefined;
    const named = /^([A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)*)\s*=(?!=)(.*)$/;
    const code = (line) => line.replace(/#.*$/, "").trimEnd(); // a # in a string: a name too few
    const names = new Set();
    for (const [k, line] of fresh.entries()) {
      const parts = named.exec(line);
      const mentions = [...names].some((name) => new RegExp(`\\b${name}\\b`).test(code(line)));
      if (line !== old[k] && /["']/.test(line + old[k])) return undefined;
      if (code(line) === code(old[k]) && !mentions) continue;
      if (!parts || named.exec(old[k])?.[1] !== parts[1]) return undefined;
      for (const name of parts[1].split(",")) names.add(name.trim());
    }
    return names;
  }

  return { graph, readers, after, spoiled, renamed };
})();
