/* The page loads itself again as long as its box is ticked. */
{
  const seconds = Number(document.currentScript.dataset.again);
  const [label, box] = ["label", "input"].map(tag => document.createElement(tag));
  Object.assign(box, {type: "checkbox", checked: true});
  label.append(box, `load this page again every ${seconds} s`);
  document.querySelector("header").append(label);
  setInterval(() => { if (box.checked) location.reload(); }, 1000 * seconds);
}
