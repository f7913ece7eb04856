// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's FileStorage as XML, which its calibration sample writes by default. Elements become the nodes that the YAML of FileStorage has:
// an element of elements a map, of "_" elements a list, the words of <data> a list of numbers. Attributes say types and are passed over.
#include <cctype>
#include <string>
#include <string_view>

#include "core/io/calibration_nodes.h"
#include "core/io/text.h"

namespace camloc {

namespace {

constexpr int kMaxDepth = 16;

/// What is left of a text; throws BadCalibration with the line.
class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  /// The content up to the end tag of `element`, which is taken.
  YAML::Node content(const std::string& element, int depth) {
    if (depth > kMaxDepth) bad("elements too deep in each other");
    YAML::Node children, list;
    std::string words;
    while (true) {
      words += take_until('<');
      const std::string tag = take_tag();
      if (tag.empty()) continue;  // declaration or comment
      if (tag[0] == '/') {
        if (tag.substr(1) != element) bad("'" + tag + "' does not end '" + element + "'");
        break;
      }
      const bool is_empty = tag.back() == '/';
      const std::string name = tag.substr(0, tag.find_first_of(" \t\r\n/"));
      const YAML::Node child = is_empty ? YAML::Node("") : content(name, depth + 1);
      if (name == "_") list.push_back(child);
      if (name != "_") children[name] = child;
    }
    if (list.size() > 0) return list;
    if (children.size() > 0) return children;
    return words_node(words, element);
  }

  /// Past what comes before the first element with this name.
  void enter(const std::string& element) {
    while (true) {
      take_until('<');
      const std::string tag = take_tag();
      if (tag.substr(0, tag.find_first_of(" \t\r\n")) == element) return;
      if (!tag.empty()) bad("expected <" + element + ">, found <" + tag.substr(0, 40) + ">");
    }
  }

 private:
  [[noreturn]] void bad(const std::string& what) const { throw BadCalibration{line_, "XML: " + what}; }

  std::string take_until(char end) {
    const std::size_t length = text_.find(end);
    if (length == std::string_view::npos) bad("it ends early");
    std::string taken(text_.substr(0, length));
    advance(length + 1);
    return taken;
  }

  /// After '<': the tag without brackets; "" for "<?...?>", "<!...>" and comments.
  std::string take_tag() {
    if (text_.starts_with("!--")) {
      const std::size_t end = text_.find("-->");
      if (end == std::string_view::npos) bad("a comment has no end");
      advance(end + 3);
      return "";
    }
    std::string tag = take_until('>');
    return tag.starts_with('?') || tag.starts_with('!') ? "" : tag;
  }

  static YAML::Node words_node(const std::string& text, const std::string& element) {
    const auto words = split_fields(text, " \t\r\n");
    if (element != "data" && words.size() <= 1) return YAML::Node(std::string(words.empty() ? "" : unquoted(words[0])));
    if (element != "data" && text.find('"') != std::string::npos) return YAML::Node(std::string(unquoted(trimmed(text))));
    YAML::Node list(YAML::NodeType::Sequence);
    for (const std::string_view word : words) list.push_back(std::string(word));
    return list;
  }

  static std::string_view unquoted(std::string_view word) {
    const bool is_quoted = word.size() >= 2 && word.front() == '"' && word.back() == '"';
    return is_quoted ? word.substr(1, word.size() - 2) : word;
  }

  void advance(std::size_t length) {
    for (const char c : text_.substr(0, length)) line_ += c == '\n' ? 1 : 0;
    text_.remove_prefix(std::min(length, text_.size()));
  }

  std::string_view text_;
  int line_ = 1;
};

}  // namespace

Result<RgbdCamera> parse_camera_xml(const std::string& text, const std::string& name, const CameraHints& hints) {
  return parse_foreign(name, [&](RgbdCamera* camera) {
    XmlReader reader(text);
    reader.enter("opencv_storage");
    YAML::Node root = reader.content("opencv_storage", 0);
    // The calibration sample's names in XML differ from its YAML in nothing; older ones have capital letters.
    for (const auto& [from, to] : {std::pair{"Camera_Matrix", "camera_matrix"},
                                   {"Distortion_Coefficients", "distortion_coefficients"},
                                   {"image_Width", "image_width"},
                                   {"image_Height", "image_height"}}) {
      if (root.IsMap() && root[from].IsDefined() && !root[to].IsDefined()) root[to] = root[from];
    }
    read_calibration(root, hints, camera);
  });
}

}  // namespace camloc
