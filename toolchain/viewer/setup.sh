#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs what the viewer of jink report is bundled from and with (three, esbuild), exactly as package-lock.json says.
# Does nothing, and needs no network, when that has been done already.
set -eu
cd "$(dirname "$0")"
stamp=node_modules/.jink-lock
if [ -f "$stamp" ] && cmp -s package-lock.json "$stamp"; then
    echo "viewer: already installed"
    exit 0
fi
npm ci --no-audit --no-fund --ignore-scripts
cp package-lock.json "$stamp"
