// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Memory of libraries that cannot be unloaded. Many C++ libraries (protobuf and OpenCV among them) have symbols that are unique in the
// process, and the loader keeps such a library for ever, whoever closes it. What they hold of their code in memory can be given back.
#pragma once

namespace camloc {

/// Gives back the pages of code and constants of the library `handle` (of dlopen) and of all that was loaded after it. They are clean
/// copies of files: whoever needs one again gets it from there. Data that was written to stays.
void give_back_library_pages(void* handle);

}  // namespace camloc
