#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a user does with installed packages; run by clean-root.sh in a root where nothing else is.
set -euo pipefail

# want TEXT COMMAND...: runs it; what it prints must have the text.
want() {
  local text=$1 said
  shift
  if ! said=$("$@" 2>&1) || ! grep --text --quiet --fixed-strings -- "$text" <<<"$said"; then
    printf '%s\n' "$said" >&2
    echo "clean-root: $*: wanted \"$text\"" >&2
    exit 1
  fi
  printf '  %-60.60s %s\n' "$*" "$(grep --text --max-count 1 --fixed-strings -- "$text" <<<"$said" | cut -c 1-70)"
}

# The main job: record, replay, assess, study, draw.
for profile in skilled unskilled; do
  for seed in 1 2 3; do
    calot record --scene touch-liver --performer "$profile" --seed "$seed" --seconds 3 --mode assessment -o "$profile-$seed.h5" >record.log
  done
done
want "bit-exact" calot replay skilled-1.h5
want "bit-exact" calot replay --apart skilled-1.h5
want "verified" calot assess ./*.h5 --cohort study.db
want "unskilled" calot study study.db --group-by performer --include-synthetic --include-practice --pdf study.pdf
want "%PDF" head -c 4 study.pdf
calot render skilled-1.h5 --at 2 -o moment.png >/dev/null
want "PNG" head -c 4 moment.png
want "frames" calot render skilled-1.h5 --from 1 --to 1.2 -o moment.mp4
want "openigtlink:HOST:PORT" calot devices
want "" calot devices print -o sheets.pdf
want "version 12: module /usr/share/calot/engines/engine-12.wasm" calot engine list
want "version 18: module /usr/share/calot/engines/engine-18.wasm" calot engine list
want "version 19: program /usr/bin/calot-engine" calot engine list
want "touch-liver.transcript: ok" calot engine check 19
want "bit-exact" calot replay /usr/share/calot/golden/touch-liver.h5
want "cholecystectomy" calot scenes

# From Python, with the scripts that come with the module.
want "'touch-liver'" python3 -c 'import calot; print(calot.scenes())'
want "bit-exact" python3 /usr/share/doc/python3-calot/examples/touch_controller.py

# Manual and completion.
want "The manual: /usr/share/doc/calot-doc/html/index.html" calot --help
for page in calot calot-record calot-study calot-engine calot-organs calot-dashboard calot-trainer; do
  want "/usr/share/man/man1/$page.1.gz" man -w "$page"
done
want "Re-simulates recordings" env MANPAGER=cat man calot-replay
cat >complete.sh <<'END'
source /usr/share/bash-completion/bash_completion
_completion_loader calot || true
COMP_WORDS=(calot record --mode a) COMP_CWORD=3
_calot
echo "completed: ${COMPREPLY[*]}"
END
want "completed: assessment" bash complete.sh
want "study" fish --command 'complete --do-complete "calot stu"'

# A double click: the type of a file, the program of the type, the program with the file.
want "application/x-calot-recording" gio info --attributes standard::content-type skilled-1.h5
want "application/x-calot-cohort" gio info --attributes standard::content-type study.db
for type in recording cohort; do
  want "calot-dashboard.desktop" gio mime "application/x-calot-$type"
done
mkdir pages
export QT_QPA_PLATFORM=offscreen
want "" calot-dashboard --pictures pages study.db
want "PNG" head -c 4 pages/attempts.png
# As the desktop entry starts it: the recording is verified and kept in the cohort of opened ones.
read -r -a command < <(sed -n 's/^Exec=//p' /usr/share/applications/calot-dashboard.desktop)
timeout 120 "${command[0]}" "$PWD/skilled-2.h5" >window.log 2>&1 &
window=$!
for _ in {1..100}; do
  if [[ -e .local/share/calot/opened.db ]] && calot cohort export .local/share/calot/opened.db -o opened >/dev/null 2>&1; then
    if grep --quiet --recursive skilled-2.h5 opened; then break; fi
    rm -rf opened
  fi
  sleep 1
done
kill "$window"
want "skilled-2.h5" grep --recursive --max-count 1 skilled-2.h5 opened
want "" timeout 60 calot-trainer --scene touch-liver --performer skilled --seconds 1
