#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the peers of tests/peer (MAVLink, ULog) with npm, exactly as package-lock.json says. Does nothing, and needs
# no network, when that has been done already.
set -eu
cd "$(dirname "$0")"
stamp=node_modules/.jink-lock
if [ -f "$stamp" ] && cmp -s package-lock.json "$stamp"; then
    echo "peer: already installed"
    exit 0
fi
npm ci --no-audit --no-fund --ignore-scripts
cp package-lock.json "$stamp"
