# Sourced by tests of pages in a real browser: finds $TALUS, $CHROMIUM and a node, makes a folder in $folder
# that goes away again; leaves the test out, with a line that says why (exit code 77), where something is
# missing. `page` makes the page that has to be there:
#
#     page WHY COMMAND...
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
export TALUS=${TALUS:-$root/build/talus}
skip() { echo "left out: $1"; exit 77; }
CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
[ -n "$CHROMIUM" ] || skip "there is no chromium (package chromium)"
command -v node >/dev/null || skip "there is no node"
version=$(node -p 'process.versions.node.split(".")[0]')
[ "$version" -ge 20 ] || skip "node is $version, 20 is needed"
[ -d "$root/framework/page/node_modules/playwright-core" ] || skip "scripts/setup has not fetched playwright-core"
export CHROMIUM
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
page() {
  local why=$1 code=0
  shift
  "$@" >/dev/null 2>"$folder/why" || code=$?
  [ "$code" = 0 ] || { cat "$folder/why"; skip "$why"; }
}
