"use strict";
// Shows what the page holds: its kind, its figures as they are written for programs, its pictures, and their colours.

const kinds = { report: reportKind, show: showKind, transfer: transferKind };
let heatColours = [];

// One by one, so that figures of another version spoil no other section; those without figures are named below.
function shownSections(sections, figures, pictures) {
  const without = [];
  const nodes = sections.map(([name, make]) => {
    try {
      const made = make(figures, pictures);
      if (made === null) without.push(name);
      made?.setAttribute("id", name);
      return made;
    } catch (error) {
      const why = `its figures are not as this page knows them (${error.message})`;
      return element("p", { class: "missing broken" }, `The section "${name}" cannot be shown: ${why}.`);
    }
  });
  const told = element("p", { class: "missing" }, `Not in this report, for want of figures: ${without.join(", ")}.`);
  return [...nodes, without.length > 0 ? told : null].filter((node) => node !== null);
}

// By their titles, where there are many.
function contentsOf(nodes) {
  const titled = nodes.filter((node) => node.getAttribute("id") && node.querySelector("h2"));
  if (titled.length < 5) return [];
  const link = (node) => element("a", { href: `#${node.getAttribute("id")}` }, node.querySelector("h2").textContent);
  return [element("nav", { "aria-label": "Contents" }, ...titled.map(link))];
}

function pageNodes(text) {
  try {
    const { kind, figures, pictures, heat_colours: palette } = JSON.parse(text);
    heatColours = palette;
    const { title, subtitle, sections } = kinds[kind](figures);
    document.title = title;
    const head = [element("h1", {}, title), element("p", { class: "subtitle" }, subtitle)];
    const shown = shownSections(sections, figures, pictures);
    return [...head, ...contentsOf(shown), ...shown];
  } catch (error) {
    return [element("p", { class: "broken" }, `The figures of this page cannot be read: ${error.message}`)];
  }
}

document.getElementById("page").append(...pageNodes(document.getElementById("contents").textContent));
