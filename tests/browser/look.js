"use strict";
// Looks at a page from inside, as it is shown in a mode, and tells the page around it what is wrong. `mode` stands before.
(() => {
  const found = [], say = (what) => { if (found.length < 60) found.push(String(what).slice(0, 300)); };
  for (const level of ["error", "warn", "log", "info", "debug"]) console[level] = (...words) => say(`console.${level}: ${words.join(" ")}`);
  addEventListener("error", (event) => {
    const asked = event.target.src || event.target.href;
    say(asked ? `asks for ${asked}` : `error: ${event.message} at ${event.lineno}`);
  }, true);
  addEventListener("unhandledrejection", (event) => say(`rejected: ${event.reason}`));
  addEventListener("securitypolicyviolation", (event) => say(`asks for ${event.blockedURI}, ${event.violatedDirective}`));

  const shown = (element) => element.checkVisibility({ visibilityProperty: true, contentVisibilityAuto: true }) && element.getClientRects().length > 0;
  const name = (element) => `${element.tagName.toLowerCase()}${element.id ? `#${element.id}` : ""} "${element.textContent.trim().replace(/\s+/g, " ").slice(0, 40)}"`;

  // Media are what the mode says: rules for the dark and for paper are made rules for this one, or for none.
  const emulate = () => {
    const walk = (rules) => {
      for (const rule of rules) {
        if (!rule.media) continue;
        const all = "(min-width: 0px)";
        let text = rule.media.mediaText;
        if (mode.paper) text = /\bscreen\b/.test(text) ? "not all" : text.replace(/\bprint\b/, "all");
        text = text.replace(/\(prefers-color-scheme: dark\)/, mode.dark ? all : "not all");
        text = text.replace(/and not all/, "and (max-width: 0px)");
        rule.media.mediaText = text;
        walk(rule.cssRules);
      }
    };
    for (const sheet of document.styleSheets) walk(sheet.cssRules);
    if (mode.paper) dispatchEvent(new Event("beforeprint"));
  };

  const overflow = () => {
    const width = document.documentElement.clientWidth;
    if (document.documentElement.scrollWidth > width) say(`the page is ${document.documentElement.scrollWidth} px wide of ${width}`);
    const scrolls = (element) => ["auto", "scroll"].includes(getComputedStyle(element).overflowX);
    for (const element of document.querySelectorAll("table, svg, figure, pre, p, li, h1, h2, h3, h4, canvas, button, input, select")) {
      if (!shown(element)) continue;
      let box = element, boxed = false;
      while ((box = box.parentElement)) boxed = boxed || scrolls(box);
      const right = element.getBoundingClientRect().right;
      if ((mode.paper || !boxed) && right > width + 0.5) say(`clipped: ${name(element)} ends at ${right} of ${width}`);
      if (mode.paper && boxed) say(`scrolls on paper: ${name(element)}`);
    }
    for (const cell of document.querySelectorAll("td, th")) {
      if (!shown(cell)) continue;
      if (cell.scrollWidth > cell.clientWidth + 1) say(`clipped in its cell: ${name(cell)}`);
      // Words in more lines than there are words are cut within.
      const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
      const range = document.createRange(), bottoms = new Set();
      let words = 0;
      while (texts.nextNode()) {
        words += texts.currentNode.data.split(/[\s-]+/).filter(Boolean).length;
        range.selectNodeContents(texts.currentNode);
        for (const line of range.getClientRects()) bottoms.add(Math.round(line.bottom / 4));
      }
      const lines = bottoms.size;
      if (!cell.querySelector("code") && lines > words + 1) say(`cut into letters: ${name(cell)}`);
    }
    for (const box of document.querySelectorAll(".wide, .picture")) {
      if (!mode.paper && shown(box) && box.scrollWidth > box.clientWidth + 1 && box.tabIndex !== 0) say(`no key scrolls ${name(box)}`);
    }
  };

  // Letters in figures, and that none lies on another.
  const figures = () => {
    const least = mode.paper ? 7 : 9;
    for (const svg of document.querySelectorAll("svg")) {
      if (!shown(svg)) continue;
      for (const part of ["title", "desc"]) if (!svg.querySelector(`:scope > ${part}`)?.textContent.trim()) say(`a figure has no ${part}`);
      if (svg.getAttribute("role") !== "img") say("a figure is no image");
      const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
      const texts = [...svg.querySelectorAll("text")];
      for (const text of svg.querySelectorAll("text, tspan")) {
        const size = parseFloat(getComputedStyle(text).fontSize) * scale;
        if (size < least) say(`letters of ${size.toFixed(1)} px: ${name(text)}`);
      }
      const boxes = texts.map((text) => [text, text.getBoundingClientRect()]);
      const all = svg.getBoundingClientRect();
      boxes.forEach(([text, a], i) => {
        if (a.left < all.left - 1 || a.right > all.right + 1) say(`beyond its figure: ${name(text)}`);
        for (const [other, b] of boxes.slice(i + 1)) {
          const across = Math.min(a.right, b.right) - Math.max(a.left, b.left), down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
          if (across > 1 && down > 0.35 * Math.min(a.height, b.height)) say(`on each other: ${name(text)} and ${name(other)} of ${svg.querySelector("title").textContent}`);
        }
      });
    }
  };

  // Words against what lies behind them, as in WCAG 2; through the filter that figures have in the dark.
  const contrast = () => {
    const read = (text) => {
      const parts = /rgba?\(([^)]*)\)/.exec(text);
      return parts ? parts[1].split(/[ ,/]+/).map(Number) : null;
    };
    const linear = (x) => (x <= 0.03928 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
    const bright = ([r, g, b]) => 0.2126 * linear(r / 255) + 0.7152 * linear(g / 255) + 0.0722 * linear(b / 255);
    const turned = (c) => {
      const [r, g, b] = c.map((x) => 255 * (0.92 - 0.84 * x / 255));
      return [-0.574 * r + 1.43 * g + 0.144 * b, 0.426 * r + 0.43 * g + 0.144 * b, 0.426 * r + 1.43 * g - 0.856 * b].map((x) => Math.min(255, Math.max(0, x)));
    };
    const filtered = (element) => {
      for (let at = element; at; at = at.parentElement) if (getComputedStyle(at).filter.includes("invert")) return at;
      return null;
    };
    const told = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      if (!walker.currentNode.data.trim() || element.closest("script, title, desc, option") || !shown(element) || element.matches("caption, .skip")) continue;
      const style = getComputedStyle(element), svg = element.closest("svg"), turn = filtered(element);
      let ink = read(svg ? style.fill : style.color), behind = svg ? [255, 255, 255] : null;
      for (let at = element; at && !behind; at = at.parentElement) {
        const back = read(getComputedStyle(at).backgroundColor);
        if (back && back[3] !== 0) behind = turn && !turn.contains(at) ? back : back;
      }
      if (!ink) continue;
      behind = behind || [255, 255, 255];
      if (turn) { ink = turned(ink); if (svg) behind = turned(behind); }
      const [a, b] = [bright(ink) + 0.05, bright(behind) + 0.05], ratio = Math.max(a, b) / Math.min(a, b);
      const key = `${ink} ${behind}`;
      if (ratio < 4.5 && !told.has(key)) { told.add(key); say(`contrast ${ratio.toFixed(2)}: ${name(element)}`); }
    }
  };

  // Every table sorts and comes back; every figure is saved.
  const use = async () => {
    for (const table of document.querySelectorAll("table")) {
      const buttons = [...table.querySelectorAll("thead button")];
      if (!shown(table) || !buttons.length) continue;
      const button = buttons.at(-1), heading = button.closest("th"), row = (one) => one.cells[one.cells.length - 1].textContent.trim();
      const bodies = [...table.tBodies].map((body) => [...body.rows].filter((one) => !one.matches(".group")));
      const order = () => [...table.tBodies].map((body) => [...body.rows].filter((one) => !one.matches(".group")));
      const plain = (text) => /^−?\d+(\.\d+)?(e-?\d+)?$|^below 10⁻⁶$/.test(text);
      const value = (text) => (text.startsWith("below") ? 1e-6 : Number(text.replace("−", "-")));
      for (const [sense, sign] of [["ascending", 1], ["descending", -1]]) {
        button.click();
        if (heading.getAttribute("aria-sort") !== sense) say(`${name(table)} is not ${sense}`);
        for (const rows of order()) {
          const numbers = rows.map(row).filter(plain).map(value);
          if (numbers.some((x, i) => i > 0 && sign * (x - numbers[i - 1]) < 0)) say(`${name(table)} is not ${sense}: ${numbers}`);
        }
      }
      button.click();
      if (heading.hasAttribute("aria-sort")) say(`${name(table)} stays sorted`);
      order().forEach((rows, i) => { if (rows.length !== bodies[i].length || rows.some((one, k) => one !== bodies[i][k])) say(`${name(table)} has another order`); });
    }
    if (document.getElementById("scene")) replay();
    const saved = [], make = URL.createObjectURL;
    URL.createObjectURL = (blob) => { saved.push(blob); return make.call(URL, blob); };
    HTMLAnchorElement.prototype.click = () => {};
    for (const button of document.querySelectorAll(".save button")) {
      const form = button.textContent, before = saved.length;
      button.click();
      for (let i = 0; i < 100 && saved.length === before; i++) await new Promise((done) => setTimeout(done, 20));
      const blob = saved[before];
      if (!blob) { say(`${button.ariaLabel}: nothing is saved`); continue; }
      const text = await blob.text();
      const right = {
        SVG: () => text.startsWith("<svg") && new DOMParser().parseFromString(text, "image/svg+xml").querySelector("parsererror") === null,
        PNG: () => blob.type === "image/png" && blob.size > 2000,
        CSV: () => text.startsWith("panel,") && text.trim().split("\n").length > 1 && !/undefined|NaN|object/.test(text),
      }[form];
      if (!right || !right()) say(`${button.ariaLabel}: not what it should be: ${text.slice(0, 80)}`);
    }
  };

  // Steps, events, keys, fingers and the way back of a replay.
  const replay = () => {
    const el = (id) => document.getElementById(id), clock = () => Number(el("time").value);
    const press = (key) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    const is = (what, right) => { if (!right) say(`replay: ${what}, at ${el("clock").textContent}`); };
    const mark = el("marks").firstElementChild, picture = () => el("scene").toDataURL();
    is("a mark", mark && parseFloat(mark.style.left) > 0);
    el("reset").click(); is("reset", clock() === 0);
    el("next").click(); const first = clock(); is("next event", first > 0);
    press("]"); is("key for the next event", clock() > first);
    press("["); is("key for the previous event", Math.abs(clock() - first) < 1e-4);
    press("."); const on = clock(); is("key for a step", on > first);
    el("back").click(); is("step back", clock() < on);
    mark.click(); is("the first mark", Math.abs(clock() - first) < 1e-4);
    const still = picture(), scene = el("scene");
    is("the picture", new Set(scene.getContext("2d").getImageData(0, 0, scene.width, scene.height).data).size > 50);
    scene.setPointerCapture = () => {};
    const finger = (type, pointerId, clientX) => scene.dispatchEvent(new PointerEvent(type, { pointerId, clientX, clientY: 200 }));
    finger("pointerdown", 1, 300); finger("pointerdown", 2, 400); finger("pointermove", 2, 450);
    is("two fingers zoom", picture() !== still);
    finger("pointermove", 2, 400); finger("pointerup", 1, 300); finger("pointerup", 2, 400);
    is("and back", picture() === still);
    finger("pointerdown", 1, 300); finger("pointermove", 1, 350); finger("pointerup", 1, 350);
    is("one finger turns", picture() !== still);
    el("reset").click(); mark.click(); is("reset turns back", picture() === still);
    if (el("boxes")) { el("boxes").click(); is("boxes", picture() !== still); el("boxes").click(); }
    const places = [...el("marks").children].map((button) => button.getBoundingClientRect());
    is("marks lie apart", places.every((place, i) => i === 0 || places[i - 1].right <= place.left));
    const stands = el("play").textContent;
    el("time").dispatchEvent(new KeyboardEvent("keydown", { key: " ", bubbles: true }));
    is("space plays from the slider too", el("play").textContent !== stands);
    el("play").click(); is("and stops", el("play").textContent === stands);
    document.querySelectorAll("#charts svg text").forEach((text) => is(`label ${text.textContent} cut off`, text.getBBox().x >= 0));
    // In charts and table the same as on the clock.
    const cursor = document.querySelector("#charts g path:last-child").getAttribute("transform");
    is("charts follow", /translate\((?!0 )/.test(cursor) && document.querySelectorAll("#charts svg").length >= 4);
  };

  addEventListener("load", async () => {
    // Virtual time ends at once where no timer runs, as while a file is read: so one does, and it ends later.
    const ticks = setInterval(() => {}, 10);
    try {
      emulate();
      await new Promise((done) => setTimeout(done, 300));
      dispatchEvent(new Event("resize"));
      overflow(); figures(); contrast();
      if (mode.use) await use();
      if (window.axe && mode.axe) {
        const { violations } = await axe.run(document, { resultTypes: ["violations"] });
        violations.forEach((v) => say(`axe ${v.id}: ${v.help}: ${v.nodes.slice(0, 3).map((n) => n.target.join(" ")).join(" | ")}`));
      }
      performance.getEntriesByType("resource").filter((entry) => !/^(data|blob):/.test(entry.name)).forEach((entry) => say(`asks for ${entry.name}`));
    } catch (error) {
      say(`the look failed: ${error.stack}`);
    }
    clearInterval(ticks);
    parent.postMessage({ name: mode.name, found }, "*");
  });
})();
