"use strict";
// Pieces of the page. Text from the figures becomes text nodes or attributes, never markup: a name is what it is.

// A null child is left out.
function element(tag, attributes, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

function shape(tag, attributes, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children.filter((child) => child !== null));
  return node;
}

function paragraph(text) {
  return element("p", {}, text);
}

// Figures that are read at a glance: [value, unit, meaning].
function headlines(list) {
  const box = ([value, unit, meaning]) =>
    element(
      "div",
      { class: "headline" },
      element("b", {}, value),
      element("i", {}, unit),
      element("span", {}, meaning),
    );
  return element("div", { class: "headlines" }, ...list.map(box));
}

// A cell that is a number: right-aligned, and compared with its column.
function numberCell(value, text = numberText(value)) {
  return { text, value };
}

// Columns by their heads; `best`: those whose lowest number is marked. Cells are texts or numberCell(); the first heads
// its row.
function table(heads, rows, best = []) {
  const isNumeric = (column) => rows.some((row) => typeof row[column] === "object");
  const lowest = heads.map((head, column) => Math.min(...rows.map((row) => row[column].value ?? Infinity)));
  const head = (text, column) => element("th", { scope: "col", class: isNumeric(column) ? "number" : "" }, text);
  const cell = (content, column) => {
    if (column === 0) return element("th", { scope: "row" }, content.text ?? content);
    if (typeof content !== "object") return element("td", {}, content);
    const isBest = best.includes(heads[column]) && content.value === lowest[column];
    return element("td", { class: isBest ? "number best" : "number" }, content.text);
  };
  return element(
    "div",
    { class: "scroll" },
    element(
      "table",
      {},
      element("thead", {}, element("tr", {}, ...heads.map(head))),
      element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell)))),
    ),
  );
}

function chart(svg, caption) {
  return element("figure", { class: "chart" }, svg, element("figcaption", {}, caption));
}

function image(picture, title) {
  return element("img", { alt: title, width: picture.width, height: picture.height, src: picture.src });
}

// A picture with labels above its equal columns, a title, a caption, and perhaps a legend.
function pictureFigure(picture, labels, title, caption, legend = null) {
  return element(
    "figure",
    {},
    element("div", { class: "columns" }, ...labels.map((label) => element("span", {}, label))),
    image(picture, title),
    element(
      "div",
      { class: "under" },
      element("figcaption", {}, element("b", {}, title), caption),
      legend && element("div", { class: "legend" }, legend),
    ),
  );
}

function section(title, ...children) {
  return element("section", {}, element("h2", {}, title), ...children);
}
