/* A table sorts by the column whose head is pressed, and can show only the rows that failed. */
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], rows = [...body.rows], heads = [...table.tHead.rows[0].cells];
  if (rows.length < 3) continue;
  table.classList.add("sorts");
  heads.forEach((head, column) => {
    if (head.tagName != "TH") return;
    const button = document.createElement("button");
    button.append(...head.childNodes);
    button.onclick = () => sort(table, rows, heads, column);
    head.append(button);
  });
  const marked = rows.filter(row => row.matches(".failed, .warning"));
  if (marked.length > 0 && marked.length < rows.length) filter(table, rows, marked);
}

/* From the lowest to the highest, then the other way round; rows without a value come last. */
function sort(table, rows, heads, column) {
  const up = heads[column].ariaSort != "ascending", sign = up ? 1 : -1;
  const text = row => row.cells[column].textContent.trim();
  const order = (a, b) => {
    const [first, second] = [text(a), text(b)], [x, y] = [first, second].map(parseFloat);
    if (!first || !second) return !first - !second;
    const numbers = Number.isFinite(x) && Number.isFinite(y) && x != y;
    return sign * (numbers ? x - y : first.localeCompare(second, "en", {numeric: true}));
  };
  heads.forEach(head => head.removeAttribute("aria-sort"));
  heads[column].setAttribute("aria-sort", up ? "ascending" : "descending");
  table.tBodies[0].append(...[...rows].sort(order));
}

function filter(table, rows, marked) {
  const [label, box] = ["label", "input"].map(tag => document.createElement(tag));
  box.type = "checkbox";
  box.onchange = () => rows.forEach(
    row => row.classList.toggle("out", box.checked && !marked.includes(row)));
  label.append(box, `only failed and warnings: ${marked.length} of ${rows.length}`);
  table.parentElement.before(label);
}
