"use strict";
// Fault trees that can be folded, searched, zoomed, and that show what a cut set brings about. Without this script the
// pages of each tree stand as they are.

const KINDS = { // whether a gate's event occurs when `count` of its `n` inputs do
  or: (count) => count > 0, por: (count) => count > 0, not: (count) => count === 0, xor: (count) => count % 2 === 1,
  vote: (count, n, k) => count >= k, true: () => true, false: () => false,
};
const every = (count, n) => n > 0 && count === n;
const SVG = "http://www.w3.org/2000/svg";

function made(name, attributes, text = "") {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

function move(element, x, y) { element.setAttribute("transform", `translate(${x} ${y})`); }

function down(element) { return Number(/ ([\d.]+)\)/.exec(element.getAttribute("transform"))[1]); }

// ---- where the cards go: as in tree_layout.py, so that what is left moves together when a branch is folded

function read(group, size) {
  const card = { group, folded: false, columns: [], inputs: [], name: group.dataset.n, y: down(group) };
  card.face = group.querySelector(":scope > .c");
  card.height = Number(card.face.firstElementChild.getAttribute("height"));
  for (const one of group.querySelectorAll(":scope > .n, :scope > .s")) {
    const stacked = one.classList.contains("s") ? [...one.children].map((inner) => read(inner, size)) : null;
    const column = stacked ? { group: one, stacked, y: down(one) } : read(one, size);
    card.columns.push(column);
    card.inputs.push(...(stacked || [column]));
  }
  for (const below of card.inputs) below.above = card;
  card.lines = [...group.querySelectorAll(":scope > .l > path")];
  card.numbers = [...group.querySelectorAll(":scope > .l > text")];
  card.foot = card.lines.length ? Number(/ ([\d.]+)V/.exec(card.lines[0].getAttribute("d"))[1]) : 0;
  return card;
}

function place(card, size) {
  const columns = card.folded ? [] : card.columns;
  Object.assign(card, { inset: 0, span: size.card, reach: card.height + size.symbol });
  let x = 0;
  for (const column of columns) {
    if (column.stacked) {
      const last = column.stacked.at(-1);
      const span = size.spine + size.card;
      Object.assign(column, { span, reach: last.y + last.height, middle: size.radius, centre: span / 2 });
    } else place(column, size);
    column.x = x;
    x += column.span + size.between;
    card.reach = Math.max(card.reach, column.y + column.reach);
  }
  if (columns.length) {
    const first = columns[0], last = columns.at(-1);
    card.inset = (first.x + first.centre + last.x + last.centre - size.card) / 2;
    card.span = Math.max(card.inset + size.card, last.x + last.span);
  }
  card.middle = card.centre = card.inset + size.card / 2;
}

function draw(card, size) {
  move(card.face, card.inset, 0);
  if (card.folded) return;
  let n = 0;
  for (const column of card.columns) {
    move(column.group, column.x, column.y);
    const x = column.x + column.middle;
    for (const below of column.stacked || [column]) {
      const end = column.stacked ? `${column.y + below.y + below.height / 2}H${column.x + size.spine}` : column.y;
      card.lines[n].setAttribute("d", `M${card.middle} ${card.foot}V${column.y - size.level / 2}H${x}V${end}`);
      card.numbers[n]?.setAttribute("x", x + 8);
      n += 1;
    }
    if (!column.stacked) draw(column, size);
  }
}

function arrange(page, size) {
  let x = 0, y = 0, width = 0, height = 0;
  for (const tree of page.trees) {
    place(tree, size);
    if (x && x + tree.span > size.widest) [x, y] = [0, height + size.level];
    move(tree.group, x, y);
    draw(tree, size);
    x += tree.span + size.between;
    [width, height] = [Math.max(width, x - size.between), Math.max(height, y + tree.reach)];
  }
  const left = () => Number(/\(([\d.]+)/.exec(page.ground.getAttribute("transform"))[1]);
  page.at ??= { width, height, left: left(), legend: page.legend && down(page.legend) };
  move(page.ground, page.at.left + (page.at.width - width) / 2, down(page.ground));
  const shorter = page.at.height - height;
  if (page.legend) move(page.legend, page.margin, page.at.legend - shorter);
  page.svg.setAttribute("viewBox", `0 0 ${page.width} ${page.height - shorter}`);
  page.svg.setAttribute("height", page.height - shorter);
}

// ---- what a cut set brings about

function brought(cards, failed) {
  const gates = new Map();
  for (const card of cards) {
    if (!card.inputs.length && !(card.group.dataset.k in KINDS)) continue;
    const gate = gates.get(card.name) ?? { kind: card.group.dataset.k, k: Number(card.group.dataset.of), inputs: [] };
    gate.inputs.push(...card.inputs.map((below) => below.name).filter((name) => name !== card.name));
    gates.set(card.name, gate);
  }
  const truth = new Map();
  const occurs = (name) => {
    if (!truth.has(name)) {
      const gate = gates.get(name);
      const count = gate?.inputs.filter(occurs).length;
      truth.set(name, gate ? (KINDS[gate.kind] ?? every)(count, gate.inputs.length, gate.k) : failed.has(name));
    }
    return truth.get(name);
  };
  const met = new Set();
  const walk = (name) => {
    if (met.has(name) || !occurs(name)) return;
    met.add(name);
    gates.get(name)?.inputs.forEach(walk);
  };
  walk(cards[0].name);
  return met;
}

// ---- one tree with its tools

function view(tree) {
  const size = JSON.parse(tree.dataset.sizes), cuts = JSON.parse(tree.dataset.cuts);
  const pages = [...tree.querySelectorAll("svg")].map((svg) => {
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    const ground = svg.querySelector(":scope > .p"), legend = svg.querySelector(":scope > .k");
    const trees = ground ? [...ground.children].map((group) => read(group, size)) : [];
    return { svg, width, height, ground, legend, trees, margin: size.margin };
  });
  const drawn = pages.filter((page) => page.ground);
  const cards = [];
  const list = (card, page) => { card.page = page; cards.push(card); for (const one of card.inputs) list(one, page); };
  for (const page of drawn) for (const one of page.trees) list(one, page);

  // zoom
  let scale = 1;
  const zoom = (wanted) => {
    scale = Math.min(4, Math.max(0.1, wanted));
    tree.style.setProperty("--scale", scale);
    percent.textContent = `${Math.round(scale * 100)} %`;
  };
  const widest = () => Math.min(1, tree.clientWidth / Math.max(...pages.map((page) => page.width)));
  const fit = () => zoom(widest());

  // fold
  const count = (card) => card.inputs.reduce((sum, one) => sum + 1 + count(one), 0);
  const fold = (card, folded) => {
    if (!card.inputs.length || card.folded === folded) return;
    card.folded = folded;
    card.group.classList.toggle("folded", folded);
    card.group.setAttribute("aria-expanded", String(!folded));
    card.badge?.remove();
    if (!folded) return;
    card.badge = document.createElementNS(SVG, "text");
    card.badge.setAttribute("class", "start head");
    card.badge.setAttribute("x", size.card / 2 - 66);
    card.badge.setAttribute("y", card.height + size.symbol / 2 + 4);
    card.badge.textContent = `+${count(card)}`;
    card.face.append(card.badge);
  };
  const folding = (some, folded) => {
    for (const card of some) fold(card, folded);
    for (const page of new Set(some.map((card) => card.page))) arrange(page, size);
  };
  const reveal = (card) => {
    const above = (one) => (one.above ? [one.above, ...above(one.above)] : []);
    folding(above(card).filter((one) => one.folded), false);
    card.face.scrollIntoView({ block: "center", inline: "center" });
  };

  // keyboard: one stop for the Tab key, arrows between the cards
  let current = cards[0];
  const focus = (card) => {
    current.group.setAttribute("tabindex", "-1");
    current = card;
    card.group.setAttribute("tabindex", "0");
    card.group.focus({ preventScroll: true });
    card.face.scrollIntoView({ block: "nearest", inline: "nearest" });
  };
  const hidden = (card) => Boolean(card.above && (card.above.folded || hidden(card.above)));
  const press = (event) => {
    const card = cards.find((one) => one.group === event.target);
    if (!card || event.ctrlKey || event.altKey || event.metaKey) return;
    const seen = cards.filter((one) => !hidden(one)), at = seen.indexOf(card);
    const keys = {
      ArrowDown: () => focus(seen[at + 1] ?? card), ArrowUp: () => focus(seen[at - 1] ?? card),
      Home: () => focus(seen[0]), End: () => focus(seen.at(-1)),
      ArrowRight: () => (card.folded ? folding([card], false) : focus(card.inputs[0] ?? card)),
      ArrowLeft: () => (card.inputs.length && !card.folded ? folding([card], true) : focus(card.above ?? card)),
      Enter: () => (card.inputs.length ? folding([card], !card.folded) : follow(card)),
      "+": () => zoom(scale * 1.25), "-": () => zoom(scale / 1.25), "0": fit,
    };
    keys[" "] = keys.Enter;
    if (keys[event.key]) { event.preventDefault(); keys[event.key](); }
  };
  const follow = (card) => {
    const target = card.face.getAttribute("href");
    const led = target && cards.find((one) => `#${one.group.id}` === target);
    if (led) { reveal(led); focus(led); }
  };

  // find
  let hits = [], hit = 0;
  const find = (step) => {
    const words = search.value.trim().toLowerCase();
    tree.querySelectorAll(".at").forEach((one) => one.classList.remove("at"));
    if (step === 0) {
      hits = words ? cards.filter((card) => card.name.toLowerCase().includes(words)) : [];
      for (const card of cards) card.group.classList.toggle("hit", hits.includes(card));
    }
    hit = hits.length ? (step ? hit + step + hits.length : 0) % hits.length : 0;
    found.textContent = words ? (hits.length ? `${hit + 1} of ${hits.length}` : "none") : "";
    if (hits.length) { hits[hit].group.classList.add("at"); reveal(hits[hit]); }
  };

  // path of a cut set
  const show = () => {
    const met = choice.value ? brought(cards, new Set(cuts[choice.value])) : new Set();
    tree.classList.toggle("path", met.size > 0);
    const on = [];
    for (const card of cards) {
      card.on = met.has(card.name) && (card.inputs.length > 0 || !card.above || card.above.on);
      card.group.classList.toggle("on", card.on);
      if (card.on) on.push(card);
    }
    for (const card of cards) {
      card.lines.forEach((line, n) => line.classList.toggle("on", card.on && card.inputs[n].on));
    }
    folding(on, false);
    if (on.length) reveal(on[0]);
  };

  // tools
  const told = `Tools for ${tree.getAttribute("aria-label")}`;
  const tools = made("div", { class: "tools", role: "group", "aria-label": told });
  const search = made("input", { type: "search", size: "18" });
  const found = made("output", {}), percent = made("output", {});
  const choice = made("select", {});
  choice.append(made("option", { value: "" }, "none"));
  cuts.forEach((events, n) => {
    choice.append(made("option", { value: n }, `${n + 1}: ${events.join(" & ") || "(no fault needed)"}`));
  });
  const label = (text, element) => {
    const one = made("label", {}, `${text} `);
    one.append(element);
    return one;
  };
  const button = (text, act, title = text) => {
    const one = made("button", { type: "button", title }, text);
    one.onclick = act;
    return one;
  };
  const gates = cards.filter((card) => card.inputs.length);
  tools.append(label("Find", search), found);
  if (cuts.length) tools.append(label("Path of cut set", choice));
  tools.append(
    button("−", () => zoom(scale / 1.25), "Smaller"), percent, button("+", () => zoom(scale * 1.25), "Larger"),
    button("Fit", fit), button("100 %", () => zoom(1)),
    button("Fold all", () => folding(gates, true)), button("Unfold all", () => folding(gates, false)),
  );
  search.oninput = () => find(0);
  search.onkeydown = (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    find(event.shiftKey ? -1 : 1);
  };
  choice.onchange = show;
  tree.before(tools);
  tree.classList.add("live");
  tree.removeAttribute("tabindex");
  for (const card of cards) {
    const { group } = card;
    group.setAttribute("role", "treeitem");
    group.setAttribute("tabindex", card === current ? "0" : "-1");
    group.setAttribute("aria-label", group.querySelector("title").textContent);
    if (card.inputs.length) group.setAttribute("aria-expanded", "true");
  }
  for (const page of pages) page.svg.style.setProperty("--wide", page.width);
  for (const page of drawn) { page.svg.setAttribute("role", "tree"); arrange(page, size); }
  tree.addEventListener("keydown", press);

  // pan by dragging; a click without a drag folds
  let drag = null;
  tree.addEventListener("pointerdown", (event) => {
    const wanted = event.button === 0 && event.pointerType === "mouse"; // a finger scrolls by itself
    drag = wanted ? { x: event.clientX, y: event.clientY, far: false } : null;
  });
  addEventListener("pointermove", (event) => {
    if (!drag || (!drag.far && Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < 5)) return;
    tree.scrollBy(drag.x - event.clientX, drag.y - event.clientY);
    drag = { x: event.clientX, y: event.clientY, far: true };
  });
  addEventListener("pointerup", () => { setTimeout(() => { drag = null; }); });
  tree.addEventListener("click", (event) => {
    if (drag?.far) { event.preventDefault(); return; }
    const face = event.target.closest(".c"), card = face && cards.find((one) => one.face === face);
    if (card && card.inputs.length) { folding([card], !card.folded); focus(card); }
  });
  tree.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(scale * (event.deltaY < 0 ? 1.1 : 1 / 1.1));
  }, { passive: false });
  addEventListener("hashchange", () => {
    const led = cards.find((card) => card.group.id && `#${card.group.id}` === location.hash);
    if (led) reveal(led);
  });
  zoom(Math.max(0.6, widest()));
}

document.querySelectorAll(".tree").forEach(view);
