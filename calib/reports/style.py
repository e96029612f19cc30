"""How a report looks: on a light screen, on a dark one, and on A4."""

STYLE = """
:root { --ink: #1b1f24; --soft: #4c545e; --paper: #ffffff; --pane: #f4f6f8; --line: #d5dae0;
        --mark: #00588c; color-scheme: light dark; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8ebef; --soft: #b3bac4; --paper: #14181d; --pane: #1f252c; --line: #3b444e;
          --mark: #6cbcf0; }
}
.no_gap, .passed { --mark: #006b4d; } .ambiguous, .warning { --mark: #805200; }
.unknown, .failed { --mark: #a33c00; }
@media (prefers-color-scheme: dark) {
  .no_gap, .passed { --mark: #4fc9a0; } .ambiguous, .warning { --mark: #e8b04a; }
  .unknown, .failed { --mark: #f0935a; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
       font: 16px/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 56rem; margin: 0 auto; padding: 1.5rem 1.25rem 4rem; }
header { background: var(--pane); border-left: 0.4rem solid var(--mark);
         padding: 1.2rem 1.5rem; border-radius: 0.3rem; }
h1 { font-size: 1.15rem; margin: 0; color: var(--soft); font-weight: 600; }
.kind { margin: 0 0 0.2rem; color: var(--mark); font-weight: 700; }
.verdict { font-size: 1.5rem; line-height: 1.3; font-weight: 650; margin: 0.5rem 0; }
h2 { font-size: 1.3rem; margin: 2.4rem 0 0.6rem; padding-bottom: 0.25rem;
     border-bottom: 1px solid var(--line); }
h3 { font-size: 1.02rem; margin: 1.4rem 0 0.2rem; }
p { margin: 0.4rem 0 0.8rem; }
header dl { display: flex; flex-wrap: wrap; gap: 0.6rem 2.2rem; margin: 1rem 0 0; }
header dl div { display: flex; flex-direction: column-reverse; }
header dt { color: var(--soft); font-size: 0.88rem; }
header dd { margin: 0; font-size: 1.45rem; font-weight: 650; }
.card { display: grid; grid-template-columns: max-content 1fr; gap: 0.35rem 1.1rem;
        background: var(--pane); border-radius: 0.3rem; padding: 0.9rem 1.2rem; margin: 0.8rem 0; }
.card dt { color: var(--soft); font-weight: 600; }
.card dd { margin: 0; overflow-wrap: anywhere; }
.wide { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; min-width: 55%; }
caption { text-align: left; color: var(--soft); font-size: 0.92rem; padding-bottom: 0.35rem; }
th, td { padding: 0.3rem 1.3rem 0.3rem 0; text-align: right; border-bottom: 1px solid var(--line); }
th:first-child { text-align: left; }
thead th { border-bottom: 2px solid var(--line); font-size: 0.92rem; }
tbody th { font-weight: 400; }
figure { margin: 1.2rem 0; }
img { display: block; width: 100%; height: auto; background: #ffffff; border-radius: 0.3rem; }
.pan { overflow-x: auto; border-radius: 0.3rem; }
.zoom { accent-color: var(--mark); }
.zoom + label { font-size: 0.92rem; color: var(--soft); margin-left: 0.3rem; }
.zoom:checked ~ .pan img { width: 230%; max-width: none; }
summary { cursor: pointer; color: var(--mark); }
h1, li, p, dd, caption { overflow-wrap: anywhere; }
.checks td, .stops td { white-space: nowrap; }
.checks td, .checks th, .stops td, .stops th { padding-right: 0.9rem; }
.checks tbody th, .stops tbody th { min-width: 11rem; }
.checks, .stops { width: 100%; font-size: 0.92rem; }
.steps td { text-align: left; vertical-align: top; }
.steps th { vertical-align: top; text-align: left; }
header .card { display: grid; background: none; padding: 0; margin: 0.8rem 0 0; }
header .card dt { font-size: 1rem; }
header .card dd { font-size: 1rem; font-weight: 600; }
.big { font-size: 2rem; line-height: 1.2; }
.checks tr.failed td:nth-child(3), .checks tr.warning td:nth-child(3),
.stops tr.failed th, .stops tr.warning th,
.steps tbody th { font-weight: 700; color: var(--mark); }
tr.unjudged td { color: var(--soft); }
:focus-visible { outline: 3px solid var(--mark); outline-offset: 2px; }
@media (max-width: 40rem) {
  main { padding: 0.8rem 0.7rem 3rem; }
  header { padding: 1rem; }
  .card { grid-template-columns: 1fr; gap: 0; }
  .card dd { margin-bottom: 0.6rem; }
  .pan img { min-width: 38rem; }
  .wide .checks, .wide .stops { min-width: 34rem; }
  .checks tbody th, .stops tbody th { min-width: 8.5rem; }
  .steps, .steps caption, .steps tbody, .steps tr, .steps th, .steps td { display: block; }
  .steps thead { display: none; }
  .steps th, .steps td { border: 0; padding-bottom: 0; }
  .steps tr { border-bottom: 1px solid var(--line); padding-bottom: 0.5rem; }
}
figcaption { color: var(--soft); font-size: 0.92rem; margin-top: 0.4rem; }
@page { size: A4; margin: 16mm 15mm; }
@media print {
  :root { --ink: #000000; --soft: #3a3a3a; --paper: #ffffff; --pane: #f4f4f4; --line: #bbbbbb;
          --mark: #00588c; color-scheme: light; }
  .no_gap, .passed { --mark: #006b4d; } .ambiguous, .warning { --mark: #805200; }
  .unknown, .failed { --mark: #a33c00; }
  body { font-size: 10pt; }
  main { max-width: none; padding: 0; }
  header { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  h2, h3, caption { break-after: avoid; }
  figure, table, .card, header { break-inside: avoid; }
  p { orphans: 3; widows: 3; }
  .zoom, .zoom + label { display: none; }
  .zoom:checked ~ .pan img { width: 100%; }
  .wide, .pan { overflow: visible; }
  .checks td, .stops td { white-space: normal; }
  .checks, .stops { font-size: 8.5pt; }
  details > summary { color: var(--soft); }
}
"""
"""Style sheet; contrast of text is 4.5 to 1 or better everywhere."""
