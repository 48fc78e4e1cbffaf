# Sourced by tests/run, examples/run and .ci/run: what a Debian or Ubuntu must have, and the build folder.

packages_to_build=(build-essential cmake ninja-build libglm-dev)
packages_to_test=("${packages_to_build[@]}" catch2 libopenexr-dev)
packages_to_show=("${packages_to_build[@]}" libopenexr-dev libpng-dev libcli11-dev libembree-dev libassimp-dev)
packages_to_measure=(pkg-config libbenchmark-dev libnanoflann-dev libflann-dev libcgal-dev)
packages_to_check=(git clang libclang-rt-dev llvm clang-format chromium)

as_root() { if (( EUID == 0 )); then "$@"; else sudo "$@"; fi; }
apt_get() { as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y "$@" </dev/null >/dev/null; }

# need PACKAGE… installs those that are missing, and does nothing when none is. What apt does not know (there is no
# Embree for every machine) is left out, and so is what is built with it.
need() {
    command -v apt-get >/dev/null || { echo "no apt here: expecting $* to be installed"; return; }
    local package missing=() known=()
    for package; do
        dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
    done
    (( ${#missing[@]} )) || return 0

    echo "installing ${missing[*]}"
    apt_get update
    for package in "${missing[@]}"; do
        if apt-cache show "$package" >/dev/null 2>&1; then known+=("$package"); else echo "no $package in apt"; fi
    done
    (( ${#known[@]} == 0 )) || apt_get install --no-install-recommends "${known[@]}"
}

# configure FOLDER [cmake options] makes the build folder, or freshens it; speaks only of trouble.
configure() {
    local generator=()
    [[ -e $1/CMakeCache.txt ]] || generator=(-G Ninja)
    cmake -S . -B "$1" "${generator[@]}" "${@:2}" >/dev/null
}

# build FOLDER TARGET… on every core.
build() { cmake --build "$1" --parallel "$(nproc)" --target "${@:2}"; }
