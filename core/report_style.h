// The look of every report: one sheet for screen, phone and paper, light and dark. Nothing is fetched from anywhere.
//
// What it dresses (see core/html.h):
//   body > main                          the page, at most 68rem wide
//   header > h1, p.subtitle              title, and in small what it was made from
//   nav.contents > ol > li > a           table of contents; in two columns where there is room, not printed
//   h2, h3, p, ul                        text; lines of text stay short enough to read
//   p.warning                            a remark that the reader must not miss
//   div.facts > div.fact > span.value, span.label     key figures side by side
//   div.table-wrap > table (caption, th.num, td.num)  wide tables scroll inside the wrap; numbers right-aligned
//   td.good, td.bad                      a check that passed, one that failed
//   details > summary                    folded away; printed as it stands on screen
//   figure > img, figcaption             a picture; stays on white in the dark scheme, because plots are drawn on white
//   div.figures > figure ...             pictures side by side where the page is wide enough
//   code, pre                            file names and commands
//   footer                               versions and origin
#pragma once

#include <string_view>

namespace underbody::core {

inline constexpr std::string_view report_style = R"css(
:root {
  color-scheme: light dark;
  --paper: #ffffff; --ink: #1c2430; --soft: #596576; --line: #d8dee6; --tint: #f3f6f9;
  --accent: #00619c; --warn-ink: #7a4100; --warn-paper: #fff4e0; --warn-line: #e69f00;
  --good: #00704f; --bad: #b3400a;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #14181d; --ink: #dfe5ec; --soft: #9aa7b5; --line: #333c47; --tint: #1c2229;
    --accent: #6cb6ea; --warn-ink: #ffd591; --warn-paper: #33270f; --warn-line: #b67d00;
    --good: #3fc79a; --bad: #ff9a66;
  }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; scroll-behavior: smooth; }
body {
  margin: 0; background: var(--paper); color: var(--ink);
  font: 1rem/1.55 system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Helvetica, Arial, sans-serif;
}
main { max-width: 68rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
header { border-bottom: 3px solid var(--accent); padding-bottom: .75rem; margin-bottom: 1.5rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .35rem; text-wrap: balance; }
h2 { font-size: 1.35rem; line-height: 1.25; margin: 2.75rem 0 .75rem; padding-top: .5rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.08rem; margin: 1.75rem 0 .5rem; }
h2, h3 { scroll-margin-top: 1rem; }
p, ul, ol { max-width: 46rem; margin: .6rem 0; }
li { margin: .2rem 0; }
a { color: var(--accent); text-underline-offset: .15em; }
.subtitle { color: var(--soft); font-size: .95rem; margin: 0; overflow-wrap: anywhere; }
nav.contents { background: var(--tint); border-radius: .5rem; padding: .6rem 1rem; }
nav.contents ol { margin: 0; padding-left: 1.6rem; max-width: none; columns: 18rem auto; column-gap: 2rem; }
nav.contents li { margin: 0; padding: .12rem 0; break-inside: avoid; }
nav.contents a { text-decoration: none; }
nav.contents a:hover, nav.contents a:focus { text-decoration: underline; }
.warning {
  color: var(--warn-ink); background: var(--warn-paper); border-left: .3rem solid var(--warn-line);
  padding: .55rem .9rem; border-radius: 0 .35rem .35rem 0; max-width: none;
}
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(10.5rem, 1fr)); gap: .75rem; margin: 1.1rem 0; }
.facts.of3 { grid-template-columns: repeat(3, 1fr); }
.facts.of4 { grid-template-columns: repeat(4, 1fr); }
.fact { background: var(--tint); border-radius: .5rem; padding: .7rem .9rem; display: flex; flex-direction: column; }
.fact .value { font-size: 1.35rem; font-weight: 650; line-height: 1.2; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
.fact .label { color: var(--soft); font-size: .88rem; line-height: 1.35; margin-top: .15rem; }
.table-wrap { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums lining-nums; }
caption { caption-side: top; text-align: left; color: var(--soft); font-size: .9rem; padding: 0 0 .4rem; }
th, td { padding: .3rem .8rem .3rem .35rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
th { font-weight: 600; border-bottom: 2px solid var(--soft); vertical-align: bottom; }
th.num, td.num { text-align: right; padding: .3rem .35rem .3rem .8rem; }
td.num { white-space: nowrap; }
th:first-child, td:first-child { min-width: 7.5rem; }
tbody tr:hover { background: var(--tint); }
td.good { color: var(--good); font-weight: 600; }
td.bad { color: var(--bad); font-weight: 600; }
details { margin: 1rem 0; border: 1px solid var(--line); border-radius: .5rem; padding: 0 .9rem; }
summary { cursor: pointer; padding: .55rem 0; font-weight: 600; }
details[open] > summary { border-bottom: 1px solid var(--line); }
figure { margin: 1.4rem 0; }
figure img {
  display: block; max-width: 100%; height: auto; margin: 0 auto; background: #fff;
  border: 1px solid var(--line); border-radius: .4rem; padding: .35rem;
}
figcaption { color: var(--soft); font-size: .9rem; line-height: 1.45; margin: .5rem 0 0; max-width: 52rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 24rem), 1fr)); gap: 1.25rem; margin: 1.2rem 0; align-items: start; }
.figures figure { margin: 0; }
code, pre { font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; font-size: .9em; }
code { background: var(--tint); border-radius: .25rem; padding: .05em .3em; }
pre { background: var(--tint); border-radius: .5rem; padding: .8rem 1rem; overflow-x: auto; }
footer { margin-top: 3rem; padding-top: .75rem; border-top: 1px solid var(--line); color: var(--soft); font-size: .88rem; }
@media (max-width: 40rem) {
  main { padding: 1.1rem .9rem 3rem; }
  h1 { font-size: 1.5rem; }
  h2 { font-size: 1.2rem; margin-top: 2.1rem; }
  table { font-size: .85rem; }
  .facts, .facts.of3, .facts.of4 { grid-template-columns: repeat(2, 1fr); gap: .5rem; }
  .fact .value { font-size: 1.1rem; }
}
@page { margin: 16mm 15mm; }
@media print {
  :root {
    color-scheme: light;
    --paper: #fff; --ink: #000; --soft: #444; --line: #bbb; --tint: #f4f4f4; --accent: #00527f;
    --warn-ink: #5c3100; --warn-paper: #fff; --good: #00543b; --bad: #8a2f05;
  }
  body { font-size: 10pt; line-height: 1.4; }
  main { max-width: none; padding: 0; }
  nav.contents { display: none; }
  a { color: inherit; text-decoration: none; }
  h2, h3, caption, summary { break-after: avoid; }
  figure, .fact, tr, .warning { break-inside: avoid; }
  thead { display: table-header-group; }
  .table-wrap { overflow: visible; }
  .figures { grid-template-columns: 1fr 1fr; }
  figure img { max-height: 105mm; width: auto; border: 0; padding: 0; }
}
)css";

}  // namespace underbody::core
