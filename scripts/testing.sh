# Functions that scripts/test and scripts/campaign share. Sourced, from the root of the clone.

jobs="${jobs:-$(nproc)}"
cmake_options=()

# All runs and all clones share these caches, which lie outside of the clone: pipelines that Mesa compiled, objects by ccache with paths
# relative to the clone, and sources that clang-tidy passed.
caches="${XDG_CACHE_HOME:-$HOME/.cache}/taxelsim-tests"
export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-$caches/mesa}" MESA_SHADER_CACHE_MAX_SIZE="${MESA_SHADER_CACHE_MAX_SIZE:-4G}"
export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$PWD}" CCACHE_NOHASHDIR=1 CCACHE_MAXSIZE="${CCACHE_MAXSIZE:-10G}"
mkdir -p build "$MESA_SHADER_CACHE_DIR"

step() {
  printf '\n== %s (%d s)\n' "$*" "$SECONDS"
}

first_of() {
  if [[ ! -e "$1" ]]; then
    echo "$0: $1 does not exist" >&2
    return 1
  fi
  echo "$1"
}

# environment_of DRIVER: environment variables with which the Vulkan loader finds that driver only.
environment_of() {
  case "$1" in
    default) ;;
    lavapipe) echo "VK_ICD_FILENAMES=$(first_of /usr/share/vulkan/icd.d/lvp_icd.*.json)" ;;
    swiftshader) echo "VK_ICD_FILENAMES=$(first_of /usr/lib/chromium/vk_swiftshader_icd.json)" ;;
    *.json) echo "VK_ICD_FILENAMES=$(first_of "$(realpath --no-symlinks "$1")")" ;;
    *) echo "$0: unknown driver $1: lavapipe, swiftshader, default or a driver's ICD file, NAME.json" >&2; return 2 ;;
  esac
}

# configure_and_build PRESET [TARGET ...]
configure_and_build() {
  local chosen="$1" options=() targets=()
  shift
  if [[ $# -gt 0 ]]; then targets=(--target "$@"); fi
  if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  if command -v mold >/dev/null; then
    options+=(-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=mold -DCMAKE_SHARED_LINKER_FLAGS=-fuse-ld=mold)
  fi
  cmake --preset "$chosen" "${options[@]}" "${cmake_options[@]}" >"build/$chosen.configure.log" 2>&1 || { cat "build/$chosen.configure.log" >&2; return 1; }
  sed -n 's/^-- \(Tests on recordings\)/\1/p' "build/$chosen.configure.log"
  cmake --build --preset "$chosen" --parallel "$jobs" "${targets[@]}" -- --quiet
}

# run_tests PRESET "VAR=value ..." [CTest arguments]: runs CTest, then prints the ten slowest tests. A CTest test is a suite of GoogleTest;
# the times of its tests are in build/PRESET/results.
run_tests() {
  local chosen="$1" environment=() status=0 suites="$PWD/build/$1.junit.xml" results="$PWD/build/$1/results"
  read -r -a environment <<<"$2"
  shift 2
  rm -rf "$suites" "$results"
  env "${environment[@]}" ctest --preset "$chosen" --parallel "$jobs" --no-tests=error --output-junit "$suites" "$@" || status=$?
  if [[ -e "$suites" ]]; then
    echo "The ten slowest suites, s:"
    slowest "$suites"
    echo "The ten slowest tests, s:"
    slowest "$results"/*.xml
  fi
  return "$status"
}

# slowest JUNIT...: the ten slowest test cases; GoogleTest writes their suite as class name after the time.
slowest() {
  sed -n -e 's/.*<testcase name="\([^"]*\)".* time="\([^"]*\)".* classname="\([^"]*\)".*/\2 \3.\1/p;t' \
    -e 's/.*<testcase name="\([^"]*\)".* time="\([^"]*\)".*/\2 \1/p' "$@" | sort -rg | sed -n '1,10p'
}
