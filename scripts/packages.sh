# Sourced by the other scripts: the Debian packages Bodyopt needs, and how to get them.

worker_build_packages=(
  cmake ninja-build g++ mold
  libvulkan-dev glslang-tools
  libeigen3-dev libnglib-dev libtinygltf-dev libmeshoptimizer-dev nlohmann-json3-dev libcli11-dev libspdlog-dev libxxhash-dev
  libpugixml-dev zlib1g-dev libhwy-dev libtbb-dev libstb-dev libspng-dev libwebp-dev
)
# What the viewport needs beside that.
viewer_packages=(libglfw3-dev libx11-dev libimgui-dev libsndfile1-dev pkg-config)
build_packages=("${worker_build_packages[@]}" "${viewer_packages[@]}" libgtest-dev pybind11-dev python3-dev python3-numpy)
# What the nodes of a farm run the program with, built without the viewport (preset `worker`): its libraries, those that no
# other of them brings along, and the loader of their GPU's driver. Netgen and Mesa bring X11, and are not among them.
worker_packages=(
  libvulkan1 libtinygltf2d libmeshoptimizer2d libspdlog1.10 libpugixml1v5 libxxhash0 libhwy1 libtbb12 libstb0 libspng0
  libwebp7 libwebpmux3
)
run_packages=(mesa-vulkan-drivers fonts-dejavu-core)
test_packages=(vulkan-validationlayers xvfb xauth xdotool clang clang-format ffmpeg)
lint_packages=(clang-tidy)
attack_packages=(libclang-rt-dev python3)
bench_packages=(libbenchmark-dev libsuitesparse-dev)
sheet_packages=(imagemagick python3)
other_program_packages=(blender python3-numpy python3-venv patchelf slurm-wlm munge chromium)
# Node.js from elsewhere brings its own npm, and Debian's would clash with it.
command -v npm >/dev/null || other_program_packages+=(nodejs npm)

# install_packages PACKAGE...: installs those that are missing; says which when it may not.
install_packages() {
  local missing=() said
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  if [ "$(id -u)" -ne 0 ]; then
    echo "These Debian packages are missing, and only root can install them:" >&2
    echo "  ${missing[*]}" >&2
    echo "Run this script as root once, or: sudo apt-get update && sudo apt-get install ${missing[*]}" >&2
    exit 1
  fi
  echo "Installing ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  # Of apt's two locks DPkg::Lock::Timeout does not wait for that of the lists. Old lists may do.
  for _ in {1..60}; do
    said=$(LC_ALL=C apt-get update -qq 2>&1) || true
    [[ $said = *"Could not get lock"* ]] || break
    echo "Another program uses apt: waiting"
    sleep 10
  done
  [ -z "$said" ] || echo "$said" >&2
  if ! apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=600 "${missing[@]}" >/dev/null; then
    echo "Packages could not be installed; apt-get says above why. Is there a network, and room on the disk?" >&2
    exit 1
  fi
}

# step NAME COMMAND...: runs it; where it fails, says which step it was and how to go on, and ends with its exit code.
step() {
  local name=$1 code
  shift
  set +e
  (set -e; "$@")
  code=$?
  set -e
  [ $code -eq 0 ] && return 0
  echo "$0: '$name' failed (exit code $code); what it printed last says why. Mend that and run the same command again:" >&2
  echo "what is installed, built or simulated already is kept." >&2
  exit $code
}

# build PRESET [TARGET...]
build() {
  local preset=$1
  shift
  local targets=()
  [ $# -gt 0 ] && targets=(--target "$@")
  [ "$(df --output=avail . | tail -n 1)" -gt 3000000 ] || echo "Less than 3 GB are free in $PWD: is that enough?" >&2
  cmake --preset "$preset"
  cmake --build --preset "$preset" "${targets[@]}"
}
