/* A table sorts by the column whose head is pressed, and can show only its marked rows: those that
   failed, and those with warnings. */
for (const table of document.querySelectorAll("table")) {
  const rows = [...table.tBodies[0].rows], heads = [...table.tHead.rows[0].cells];
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
  if (marked.length > 0 && marked.length < rows.length) addFilter(table, rows, marked);
}

/* From the lowest to the highest, then the other way round; rows without a value come last. */
function sort(table, rows, heads, column) {
  const up = heads[column].ariaSort != "ascending", sign = up ? 1 : -1;
  const textOf = row => row.cells[column].textContent.trim();
  const compare = (a, b) => {
    const first = textOf(a), second = textOf(b);
    if (first == "" || second == "") return Number(first == "") - Number(second == "");
    const x = parseFloat(first), y = parseFloat(second);
    const areNumbers = Number.isFinite(x) && Number.isFinite(y) && x != y;
    return sign * (areNumbers ? x - y : first.localeCompare(second, "en", {numeric: true}));
  };
  heads.forEach(head => head.removeAttribute("aria-sort"));
  heads[column].setAttribute("aria-sort", up ? "ascending" : "descending");
  table.tBodies[0].append(...[...rows].sort(compare));
}

function addFilter(table, rows, marked) {
  const [label, box] = ["label", "input"].map(tag => document.createElement(tag));
  box.type = "checkbox";
  box.onchange = () => rows.forEach(
    row => row.classList.toggle("out", box.checked && !marked.includes(row)));
  label.append(box, `only failed and warnings: ${marked.length} of ${rows.length}`);
  table.parentElement.before(label);
}
