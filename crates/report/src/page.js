"use strict";
// What a page can do more where scripts run: tables sort, figures are saved. Nothing looks different before.
(() => {
  const each = (what, within, of) => within.querySelectorAll(what).forEach(of);
  const button = (words, click) => {
    const made = document.createElement("button");
    made.type = "button"; made.className = "plain"; made.append(...words); made.onclick = click;
    return made;
  };

  // The first number of a text, by its value; of none and all of the runs, shares in percent.
  const number = (text) => {
    const plain = text.trim().replace(/[−‒–](?=[\d.])/g, "-").replace(/(\d)[\u2009\u202f\u00a0](?=\d{3})/g, "$1")
      .replace(/\b\d{1,3}(,\d{3})+\b/g, (all) => all.replaceAll(",", ""));
    const power = /^below 10([⁻⁰¹²³⁴-⁹]+)$/.exec(plain);
    if (power) return 10 ** +[...power[1]].map((c) => (c === "⁻" ? "-" : "⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c))).join("");
    if (/^(none|all)\b/.test(plain)) return plain.startsWith("all") ? 100 : 0;
    const found = /^[([<>≤≥~ ]*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|[-+]?inf)/i.exec(plain);
    if (!found) return NaN;
    return /inf$/i.test(found[1]) ? (found[1].startsWith("-") ? -Infinity : Infinity) : +found[1];
  };
  // Numbers by value, then words; what is not there stands last, whatever the order.
  const compare = (a, b, down) => {
    const [x, y] = [a, b].map(number), missing = (text) => /^[–-]?$/.test(text.trim());
    if (missing(a) || missing(b)) return missing(a) - missing(b);
    const order = isNaN(x) || isNaN(y)
      ? isNaN(x) - isNaN(y) || a.localeCompare(b, "en", { numeric: true })
      : x < y ? -1 : +(x > y);
    return down ? -order : order;
  };
  // The headings of single columns, by their column.
  const headings = (table) => {
    const rows = [...table.tHead.rows], taken = rows.map(() => []), found = [];
    rows.forEach((row, i) => {
      let column = 0;
      for (const cell of row.cells) {
        while (taken[i][column]) column++;
        for (let k = i; k < Math.min(rows.length, i + cell.rowSpan); k++) {
          for (let j = 0; j < cell.colSpan; j++) taken[k][column + j] = true;
        }
        if (cell.scope === "col") found[column] = cell;
        column += cell.colSpan;
      }
    });
    return found;
  };
  each("table", document, (table) => {
    if (!table.tHead || ![...table.tBodies].some((body) => body.querySelectorAll("td:first-of-type").length > 1)) return;
    const bodies = [...table.tBodies].map((body) => [body, [...body.rows].filter((row) => !row.matches(".group"))]);
    const found = headings(table);
    found.forEach((heading, column) => {
      each("p", heading, (line) => {
        const span = document.createElement("span");
        span.className = "line"; span.append(...line.childNodes); line.replaceWith(span);
      });
      if (!heading.textContent.trim()) return;
      heading.append(button([...heading.childNodes], () => {
        const order = { ascending: "descending", descending: "none" }[heading.ariaSort] || "ascending";
        found.forEach((other) => other.removeAttribute("aria-sort"));
        if (order !== "none") heading.ariaSort = order;
        for (const [body, rows] of bodies) {
          const sorted = order === "none" ? rows : rows.slice().sort((a, b) =>
            compare(a.cells[column].textContent, b.cells[column].textContent, order === "descending"));
          body.append(...sorted);
        }
      }));
    });
  });

  const save = (blob, name) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob); link.download = name; link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const quoted = (field) => {
    const text = field === null ? "" : String(field);
    return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  // Panels below each other; a head stands wherever it changes.
  const table = (sheets) => {
    let head = "";
    const lines = sheets.flatMap(({ panel, columns, rows }) => {
      const own = ["panel", ...columns].map(quoted).join(), before = head;
      head = own;
      return [...(own === before ? [] : [own]), ...rows.map((row) => [panel, ...row].map(quoted).join())];
    });
    return lines.join("\n") + "\n";
  };
  each("figure", document, (figure) => {
    const svg = figure.querySelector("svg"), numbers = figure.querySelector(".numbers");
    if (!svg) return;
    const drawing = () => new XMLSerializer().serializeToString(svg);
    const picture = () => {
      const image = new Image(), [wide, high] = ["width", "height"].map((side) => 2 * svg.getAttribute(side));
      image.onload = () => {
        const canvas = document.createElement("canvas");
        canvas.width = wide; canvas.height = high;
        canvas.getContext("2d").drawImage(image, 0, 0, wide, high);
        canvas.toBlob((blob) => save(blob, `${figure.id}.png`));
      };
      image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(drawing())}`;
    };
    const links = document.createElement("span");
    links.className = "save";
    const add = (form, click) => {
      const link = button([form], click);
      link.ariaLabel = `Save ${figure.id} as ${form}`;
      links.append(" ", link);
    };
    links.append(" Save as");
    add("SVG", () => save(new Blob([drawing()], { type: "image/svg+xml" }), `${figure.id}.svg`));
    add("PNG", picture);
    if (numbers) add("CSV", () => save(new Blob([table(JSON.parse(numbers.textContent))], { type: "text/csv" }), `${figure.id}.csv`));
    figure.querySelector("figcaption").append(links);
  });

  // What is wider than its box is scrolled by keys too.
  const boxes = () => each(".wide, .picture, pre", document, (box) => {
    if (box.scrollWidth <= box.clientWidth + 1) {
      ["tabindex", "role", "aria-label"].forEach((name) => box.removeAttribute(name));
      return;
    }
    const words = box.querySelector(box.matches(".wide") ? "caption" : "title");
    box.tabIndex = 0; box.role = "group";
    box.ariaLabel = `${words ? words.textContent : box.matches("pre") ? "Text" : "Table"}, wider than the page`;
  });
  boxes();
  window.addEventListener("resize", boxes);
  // What is folded has no width before.
  document.addEventListener("toggle", boxes, true);
  // Paper shows what is folded.
  let folded = [];
  window.addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details:not([open])")];
    folded.forEach((part) => { part.open = true; });
  });
  window.addEventListener("afterprint", () => folded.forEach((part) => { part.open = false; }));
})();
