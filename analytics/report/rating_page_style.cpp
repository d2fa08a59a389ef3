// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/rating_page.h"

namespace calot::analytics {

const char* ratingPageStyle() {
  return R"~(
:root { color-scheme: light dark; --back: #fff; --text: #1b1d21; --soft: #5a6069; --line: #c9ced6; --mark: #0b5cad;
  --onmark: #fff; --card: #f5f6f8; --warn: #a3180f; }
@media (prefers-color-scheme: dark) { :root { --back: #15171a; --text: #e8eaed; --soft: #a6adb7; --line: #434a54;
  --mark: #7db8f5; --onmark: #10151b; --card: #1f2327; --warn: #ff9d93; } }
* { box-sizing: border-box; }
body { margin: 0; padding: 12px 20px; background: var(--back); color: var(--text); font: 16px/1.4 system-ui, sans-serif; }
header { display: flex; justify-content: space-between; align-items: center; gap: 20px; }
h1 { font-size: 18px; margin: 0; } h2 { font-size: 17px; margin: 0 0 6px; } h2:focus { outline: none; }
header p { margin: 2px 0 0; color: var(--soft); }
#message { margin: 10px 0 0; padding: 8px 12px; border: 1px solid currentColor; border-radius: 6px; color: var(--warn); }
#message.good { color: var(--mark); }
#list { display: flex; flex-wrap: wrap; gap: 6px; list-style: none; padding: 0; margin: 10px 0 12px; }
button { font: inherit; color: inherit; background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  padding: 6px 14px; cursor: pointer; }
button:hover { border-color: var(--mark); }
#save, #next { background: var(--mark); border-color: var(--mark); color: var(--onmark); }
#list button { min-width: 52px; padding: 4px 10px; }
#list button[aria-current] { border-color: var(--mark); box-shadow: inset 0 0 0 1px var(--mark); font-weight: 600; }
:focus-visible { outline: 3px solid var(--mark); outline-offset: 2px; }
main { display: grid; grid-template-columns: minmax(0, 1.55fr) minmax(380px, 1fr); gap: 22px; align-items: start; }
video { width: 100%; max-height: calc(100vh - 210px); min-height: 200px; background: #000; display: block; border-radius: 6px; }
.hint { color: var(--soft); font-size: 14px; margin: 8px 0 0; }
#items h3 { font-size: 15px; margin: 10px 0 4px; } #items h3:first-child { margin-top: 0; }
fieldset { border: 0; border-top: 1px solid var(--line); margin: 0; padding: 8px 0 9px; min-width: 0; }
legend { padding: 0; float: left; width: 100%; font-weight: 600; margin-bottom: 4px; }
.scores { clear: both; display: flex; flex-wrap: wrap; gap: 6px; }
.scores label { display: flex; align-items: center; gap: 5px; padding: 3px 9px 3px 6px; border: 1px solid var(--line);
  border-radius: 6px; cursor: pointer; }
.scores label:has(input:checked) { border-color: var(--mark); box-shadow: inset 0 0 0 1px var(--mark); }
.scores label.blank { color: var(--soft); margin-left: auto; }
.scores input { margin: 0; accent-color: var(--mark); width: 16px; height: 16px; }
.anchors { margin: 5px 0 0; padding: 0; list-style: none; color: var(--soft); font-size: 14px; }
.step { display: flex; justify-content: space-between; border-top: 1px solid var(--line); margin: 0; padding-top: 10px; }
@media (max-width: 900px) { main { grid-template-columns: minmax(0, 1fr); } }
)~";
}

}  // namespace calot::analytics
