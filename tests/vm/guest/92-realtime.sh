# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The drop-in for real-time priority: every thread has it, although the sandbox forbids to ask for it.
use_sample_room
mkdir -p /etc/systemd/system/camlocd.service.d
cp /usr/share/doc/camloc/examples/realtime.conf /etc/systemd/system/camlocd.service.d/
# On an emulated processor a frame may take longer than the second after which the drop-in sees a fault.
unit_setting LimitRTTIME=30s WatchdogSec=60
systemctl restart camlocd
within 30 status_has '"state":"LOCALIZED"'
for task in /proc/"$(main_pid)"/task/*; do
  chrt -p "$(basename "$task")" | grep -q SCHED_FIFO || fail "thread $(cat "$task/comm"): $(chrt -p "$(basename "$task")")"
  chrt -p "$(basename "$task")" | grep -q 'priority: 20' || fail "thread $(cat "$task/comm"): $(chrt -p "$(basename "$task")")"
done
[[ $(cat "/sys/fs/cgroup/system.slice/camlocd.service/memory.min") == 134217728 ]] || fail "its memory is not protected"
rm -r /etc/systemd/system/camlocd.service.d
systemctl daemon-reload
