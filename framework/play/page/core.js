// The core of Talus in a worker of its own, so that nothing it does stops the page. A request that
// takes too long ends with its worker; the next one finds a new worker.
//
//     const core = startCore(await coreOf(document), files);
//     const read = await core.ask({ do: "read", text, file }, 5);     // at most 5 seconds
//     core.stop();                                                    // whatever is being done
import glue from "./worker.txt";

// The core as it stands in the page: its script, and the module, compressed.
export async function coreOf(page) {
  const packed = Uint8Array.from(atob(page.getElementById("module").textContent.replace(/\s/g, "")), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return { script: page.getElementById("core").textContent, module: await new Response(stream).arrayBuffer() };
}

export function startCore({ script, module }, files = {}) {
  const url = URL.createObjectURL(new Blob([script, "\n", glue], { type: "text/javascript" }));
  let worker = null, next = 0, waiting = new Map();

  function begin() {
    worker = new Worker(url);
    worker.onmessage = ({ data }) => {
      const one = waiting.get(data.id);
      if (!one) return;
      waiting.delete(data.id);
      clearTimeout(one.timer);
      if (data.broken) { stop(`The core has given up: ${data.broken}`); one.resolve(failed(data.broken)); }
      else one.resolve(JSON.parse(data.answer));
    };
    worker.onerror = event => { event.preventDefault(); stop(`The core cannot be run here: ${event.message}`); };
    worker.postMessage({ id: ++next, module, files });
  }
  const failed = text => ({ error: { text, file: "", line: 0, column: 0 }, ended: true });
  function stop(why = "stopped") {
    worker?.terminate();
    worker = null;
    const all = waiting;
    waiting = new Map();
    for (const one of all.values()) { clearTimeout(one.timer); one.resolve(failed(why)); }
  }
  // The answer, an object; never throws.
  function ask(request, seconds = 0) {
    if (!worker) begin();
    const id = ++next;
    return new Promise(resolve => {
      const timer = seconds ? setTimeout(() => stop(
        `stopped after ${seconds} seconds\n  expected a model that is read in a moment; is there a loop without an end?`), 1000 * seconds) : 0;
      waiting.set(id, { resolve, timer });
      worker.postMessage({ id, request: JSON.stringify(request) });
    });
  }
  begin();
  return { ask, stop, get busy() { return waiting.size > 0; } };
}
