// A pack is a package in one file, compressed: the length of a list, the list (sizes of files by their
// paths, as JSON), and then the files. What came broken off does not unpack.
export async function unzipped(answer) {
  const content = answer.body.pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(content).arrayBuffer());
}

// Put the files of a pack below a folder. Libraries are loaded here, where Python waits for nothing:
// in the middle of an import each takes twice as long.
export async function unpack(python, root, pack) {
  let at = 4 + new DataView(pack.buffer).getUint32(0, true);
  const sizes = JSON.parse(new TextDecoder().decode(pack.subarray(4, at)));
  const paths = Object.keys(sizes).map((path) => `${root}/${path}`);
  for (const folder of new Set(paths.map((path) => path.slice(0, path.lastIndexOf("/")))))
    python.FS.mkdirTree(folder);
  Object.values(sizes).forEach((size, k) =>
    python.FS.writeFile(paths[k], pack.subarray(at, (at += size)), { canOwn: true }),
  );
  for (const path of paths) if (path.endsWith(".so")) await python._api.loadDynlib(path);
}
