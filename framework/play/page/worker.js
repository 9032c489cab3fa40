// Runs in the worker, behind the text of the core: requests in, answers out, in order.
/* global talusCore */
const ready = talusCore({ print: () => {}, printErr: () => {} });
onmessage = async event => {
  const { id, files, request } = event.data, core = await ready;
  if (files) {
    for (const [path, text] of Object.entries(files)) {
      const parts = path.split("/").slice(0, -1);
      parts.forEach((_, i) => { try { core.FS.mkdir(parts.slice(0, i + 1).join("/")); } catch { /* there */ } });
      core.FS.writeFile(path, text);
    }
    return postMessage({ id, answer: "{}" });
  }
  try {
    postMessage({ id, answer: core.ccall("talus_answer", "string", ["string"], [request]) });
  } catch (error) {  // out of memory, say: the page starts another worker
    postMessage({ id, broken: String(error) });
  }
};
