# A kernel that sees the system and its own folder, which lies two below a folder of the course. It
# writes to nothing else, has no network, and whatever it starts ends with it.
prefix=$1 connection=$2
course=$(dirname "$(dirname "$(dirname "$PWD")")")
python=$("$prefix/bin/python" -c 'import sys; print(sys.base_prefix)')
ulimit -f 200000 # blocks of 512 bytes: a file
ulimit -v 16000000 # KB: the memory
exec bwrap --die-with-parent --unshare-all --ro-bind / / --dev /dev --proc /proc \
  --tmpfs /tmp --tmpfs "$HOME" --tmpfs "$course" --bind "$PWD" "$PWD" \
  --ro-bind "$python" "$python" --ro-bind "$prefix" "$prefix" \
  --bind "$(dirname "$connection")" "$(dirname "$connection")" \
  --unsetenv JPY_PARENT_PID --chdir "$PWD" "$prefix/bin/python" -m ipykernel_launcher -f "$connection"
