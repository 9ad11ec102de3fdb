#!/usr/bin/env bash
# Chromium shows the pages that the program writes: no script fails, figures and pictures are there, names are text.
. "$(dirname "$0")/head.bash"
needs chromium node
$bodyopt demo --quick --out "$folder/demo" >/dev/null
cat >"$folder/shots.json" <<'END'
{"schema": "bodyopt-shots-1",
 "defaults": {"basis": "demo/basis.safetensors", "clip": "demo/heldout.glb", "device": "cpu", "out": "out/{element}.pc2"},
 "elements": [{"shot": "a<img src=x onerror=alert(1)>", "element": "arm"}, {"shot": "open", "element": "other"}]}
END
$bodyopt farm plan "$folder/shots.json" --out "$folder/plan" >/dev/null
$bodyopt farm run "$folder/plan" >/dev/null
rm "$folder/out/other.pc2"
$bodyopt farm report "$folder/plan" --out "$folder/show.html" >/dev/null
for page in "$folder/demo/report.html" "$folder/demo/transfer.html" "$folder/show.html"; do
  chromium --headless --no-sandbox --disable-gpu --user-data-dir="$folder/profile" --enable-logging=stderr --dump-dom \
    "file://$page" >"$folder/dom.html" 2>"$folder/log"
  if grep CONSOLE "$folder/log"; then exit 1; fi
  node tests/other_programs/read_page.mjs "$page" "$folder/dom.html"
done
