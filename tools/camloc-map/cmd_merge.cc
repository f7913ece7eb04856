// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map merge: two maps of one building become one.
#include <CLI/CLI.hpp>
#include <memory>

#include "core/map/map_unpack.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/terminal_observer.h"
#include "tools/mapping/build/merge_pipeline.h"

namespace camloc::mapping {
namespace {

constexpr const char* kFooter =
    "FIRST keeps its frame, its poses and its datum; SECOND is localized in it and bent onto it. Landmarks that both saw become\n"
    "one, with further descriptors where they look different on another day; the rest is added, and what is most useful is kept\n"
    "within the budget. Maps without a place in common are refused. --out may be FIRST itself; Ctrl-C leaves it untouched.\n"
    "Example: camloc map merge monday.cmap tuesday.cmap --out building.cmap --max-bytes 3MB\n"
    "Exit code: 0 done, 1 failed, 2 wrong usage or maps that do not fit.";

struct MergeArguments {
  std::string first, second, map_path;
  MapMergeOptions options;
  bool is_json = false;
};

Status merge_files(const MergeArguments& arguments, MergeSummary* summary) {
  auto b = MapView::open(arguments.second);
  if (!b.is_ok()) return b.status();
  const auto a = MapView::open(arguments.first);
  if (!a.is_ok()) return a.status();
  if (a.value().info().map_id == b.value().info().map_id)
    return {ErrorCode::kInvalid, arguments.first + " and " + arguments.second + " are the same map: there is nothing to merge"};
  const MapData second = unpack_map(b.value());
  if (b.value().is_damaged()) return {ErrorCode::kCorrupt, arguments.second + ": could not be read to its end; was it changed meanwhile?"};
  summary->map_b = arguments.second;
  tools::TerminalObserver observer;
  const Status merged = merge_into(arguments.first, second, arguments.options, arguments.map_path, observer, summary);
  return merged.code() == ErrorCode::kInvalid ? merged.with_context(arguments.first + " and " + arguments.second) : merged;
}

int run(const MergeArguments& arguments) {
  if (const Status output = tools::check_output_path("--out", arguments.map_path); !output.is_ok()) return report_error(output, 2);
  MergeSummary summary;
  if (const Status merged = merge_files(arguments, &summary); !merged.is_ok()) return report(merged);
  const std::string text = arguments.is_json ? format_json(summary) : format_table(summary);
  return tools::print_text(text) ? 0 : 1;
}

}  // namespace

void add_merge_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<MergeArguments>();
  CLI::App* command = app.add_subcommand("merge", "Merges two maps of one building, for example of two days.");
  command->footer(kFooter);
  command->add_option("FIRST", arguments->first, "Map file whose frame stays")->required();
  command->add_option("SECOND", arguments->second, "Map file that is added")->required();
  command->add_option("--out", arguments->map_path, "Map file to write; replaced only when the new one is complete")->required();
  command
      ->add_option("--max-bytes", arguments->options.map.max_bytes, "Size limit of the file; what is most useful is kept (accepts KB, MB)")
      ->transform(CLI::AsSizeValue(true));
  command->add_flag("--json", arguments->is_json, "Print the summary as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::mapping
