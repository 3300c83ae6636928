// The style sheet of the evaluation's report.
#pragma once

namespace binpick::app {

inline constexpr const char* kReportStyle = R"css(
:root { --ink: #1c2430; --soft: #5c6878; --line: #dde3ea; --ground: #f5f7f9; --card: #ffffff;
  --accent: #1769aa; --right: #2da44e; --wrong: #d1242f; --miss: #c27803; --neutral: #8492a6; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e3e8ee; --soft: #9aa7b5; --line: #2e3742; --ground: #12171d; --card: #1a2129;
    --accent: #62b0f0; --right: #4cd07d; --wrong: #ff6b6b; --miss: #f0b429; --neutral: #94a3b8; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 32px 24px 64px; }
h1 { font-size: 26px; margin: 0 0 4px; letter-spacing: -0.01em; }
h2 { font-size: 18px; margin: 40px 0 12px; }
p.lead { color: var(--soft); margin: 0 0 20px; max-width: 80ch; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 16px;
  overflow-x: auto; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(120px, 1fr)); gap: 12px; }
.tile b { display: block; font-size: 26px; line-height: 1.2; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: 13px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums;
  font-size: 13.5px; }
th { font-weight: 600; color: var(--soft); font-size: 12.5px; text-align: right; padding: 4px 7px;
  border-bottom: 2px solid var(--line); white-space: nowrap; vertical-align: bottom; }
td { text-align: right; padding: 5px 7px; border-bottom: 1px solid var(--line);
  white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: 2px; }
tr:last-child td { border-bottom: 0; }
tr.mean td { font-weight: 600; border-top: 2px solid var(--line); }
td.main { font-weight: 600; color: var(--accent); }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(270px, 1fr)); gap: 12px; }
.charts h3 { margin: 0 0 6px; font-size: 14px; }
svg.chart { width: 100%; max-width: 340px; height: auto; display: block; }
svg .grid { stroke: var(--line); stroke-width: 1; }
svg .tick { fill: var(--soft); font-size: 10px; }
svg .axis { fill: var(--soft); font-size: 11px; }
svg .curve { fill: none; stroke: var(--accent); stroke-width: 2; stroke-linejoin: round; }
svg .diagonal { stroke: var(--soft); stroke-width: 1; stroke-dasharray: 4 4; }
svg .interval { stroke: var(--accent); stroke-width: 1.5; }
svg .best { fill: var(--card); stroke: var(--accent); stroke-width: 2.5; }
.charts h3 span { color: var(--soft); font-weight: 400; float: right; }
svg.bar { width: 100%; height: 18px; display: block; border-radius: 3px; }
td.bar-cell { width: 55%; }
.stage-0 { fill: #4c78a8; background: #4c78a8; } .stage-1 { fill: #f58518; background: #f58518; }
.stage-2 { fill: #e0b83c; background: #e0b83c; } .stage-3 { fill: #72b7b2; background: #72b7b2; }
.stage-4 { fill: #54a24b; background: #54a24b; } .stage-5 { fill: #e45756; background: #e45756; }
.stage-6 { fill: #b279a2; background: #b279a2; } .stage-7 { fill: #9d755d; background: #9d755d; }
.stage-8 { fill: #8a939c; background: #8a939c; }
.line { fill: none; stroke-width: 1.8; stroke-linejoin: round; }
.line-0 { stroke: #4c78a8; } .line-1 { stroke: #f58518; } .line-2 { stroke: #e0b83c; }
.line-3 { stroke: #72b7b2; } .line-4 { stroke: #54a24b; } .line-5 { stroke: #e45756; }
.line-6 { stroke: #b279a2; } .line-7 { stroke: #9d755d; } .line-8 { stroke: #8a939c; }
.legend { display: flex; flex-wrap: wrap; gap: 6px 18px; margin: 0 0 12px; color: var(--soft);
  font-size: 13px; }
.legend i { display: inline-block; width: 12px; height: 12px; border-radius: 3px; margin-right: 6px;
  vertical-align: -1px; }
i.right { background: #3cdc5a; } i.wrong { background: #ff3c3c; } i.miss { background: #ffbe1e; }
i.neutral { background: #96a5b9; }
figure { margin: 0 0 20px; } figure img { max-width: 100%; max-height: 520px; display: block;
  border-radius: 6px; }
figcaption { color: var(--soft); font-size: 13.5px; margin-top: 6px; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(520px, 1fr));
  gap: 4px 16px; }
.crops { display: grid; grid-template-columns: repeat(auto-fill, minmax(380px, 1fr));
  gap: 4px 16px; }
.crops img { width: 100%; }
.causes td { text-align: left; } .causes td:last-child { white-space: normal; }
.faults { border-left: 4px solid var(--wrong); }
.faults ul { margin: 0; padding-left: 20px; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 4px 20px; margin: 0; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
@media (max-width: 640px) { .pictures { grid-template-columns: 1fr; } }
)css";

}  // namespace binpick::app
