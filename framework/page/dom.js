// Small helpers to make elements.
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(Infinity).filter(c => c !== null && c !== undefined && c !== false));
  return element;
}

export const number = (v, digits = 4) => {
  if (v === null || v === undefined || !Number.isFinite(v)) return "–";
  if (v === 0) return "0";
  const a = Math.abs(v);
  const text = a >= 1e6 || a < 1e-6 ? v.toExponential(digits - 1) : a >= 10 ** digits ? v.toFixed(0) : String(+v.toPrecision(digits));
  return text.replace("-", "−");
};
export const signed = (v, digits) => (v > 0 ? "+" : "") + number(v, digits);
// As many decimals as the uncertainty has with two digits.
export function withStd(v, std) {
  if (v === null || v === undefined) return "–";
  if (!(std > 0)) return number(v, 6);
  const decimals = Math.max(0, Math.min(9, 1 - Math.floor(Math.log10(std))));
  return v.toFixed(decimals).replace("-", "−");
}
export const unitText = unit => !unit || unit === "1" ? "" : unit;
export const spoken = name => name.replaceAll("_", " ");

// columns: [{title, text: true where it is words, wide, short}], rows: arrays of strings or nodes;
// paper(k): whether row k is printed.
export function table(columns, rows, { onrow, caption, keys, paper } = {}) {
  const kind = c => [c.text ? "t" : "", c.wide ? "w" : "", c.short ? "s" : ""].join(" ").trim() || null;
  const body = rows.map((row, k) => {
    const act = onrow ? () => onrow(k) : null;
    return h("tr", { class: paper && !paper(k) ? "offpaper" : null, tabindex: act ? 0 : null, "data-key": keys?.[k], onclick: act ?? (() => {}),
      onkeydown: e => { if (act && e.key === "Enter") act(); } },
      row.map((cell, i) => h("td", { class: kind(columns[i]) }, cell ?? "–")));
  });
  return h("div", { class: "wide" }, h("table", {}, caption ? h("caption", {}, caption) : null,
    h("thead", {}, h("tr", {}, columns.map(c => h("th", { class: kind(c), scope: "col" }, c.title)))),
    h("tbody", {}, body)));
}

export function download(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = h("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

export function section(id, title, ...children) {
  return h("section", { id, "aria-labelledby": id + "-title" }, h("h2", { id: id + "-title" }, title), ...children);
}
