// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A library by the name of OpenNI2 that is something else.
extern "C" __attribute__((visibility("default"))) int oniInitialize(int) { return 0; }
