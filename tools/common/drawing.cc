// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A pixel is covered as far as its centre is inside of a line's outline, half a pixel on either side of it; letters are strokes of lines.
#include "tools/common/drawing.h"

#include <algorithm>
#include <cmath>

namespace camloc::tools {
namespace {

constexpr double kGlyphHeight = 24;  // of a capital letter, in units of the strokes
constexpr int kGlyphDescent = 8;     // how far below the line of text the strokes' coordinates begin

/// ASCII 32 to 126, each ended by '|': the width with the gap to the next letter, then strokes with a blank between them, each a list of
/// points (right, up); a number is its character less '0'.
constexpr std::string_view kGlyphs =
    ">|81?1P 1818|=1I1P 7I7P|H488P ;8?P 1@A@ 2HBH|F=N;P7P4O2M1J2G5E8D<C?A@>?;<988491; 858S|"
    "H18AP 8K7O4P1O0K1G4F7G8K B=AA>B;A:=;9>8A9B=|HB85G5H4J4M5O7P9P;O<M<J;H3B1A0>1;3978:9AB|81I1P|;5Q2J1B2953|;1Q4J5B4:13|"
    "A6B6N 1E;K 1K;E|F8:8J 0B@B|9383713|@0B:B|81818|B05<S|D>D=J:N7P4N1J0D1>3:78::=>>D|C2K8P88|D0K2N5P8P;N=L>I=F08>8|"
    "D1M4O6P:O<M<J<G:E6D7D:C=A>>=;:978390;|E;8;P0???|D=P2P1E2G6H9H<E>B>><;9968290<|D<P5I0A2E5G9G<E>A>><:98582:0>0A|D0P>P58|"
    "D7D:E<G<J<M:O7P4O2M2J2G4E7D 7D4C1A0>1;3978:9=;>>=A:C7D|D289?>G>J<N9P5P2N0J0G2C5A9A<C>G|81818 1E1E|9383713 3E3E|D>;0B>I|"
    "E0??? 0F?F|D0;>B0I|B0K1N3O6P9O;M<K<H:F6B6? 6868|MAD@G>I<J:I8G7D8A9?<>>?@AADA@B?C>E>F?G@GDGEDK@O:P5M2G1A4;87>6C9|F088P@8 3@=@|"
    "F0D8D;E=G>J=M;O8P0P0898<9?;@>?A<C9D|E?L;P7P3L0G0A3<78;8?<|F080P6P;N?J@D?>;:6808|C=P0P08=8 0D;D|C=P0P08 0D;D|"
    "G?L<O7P4N1I0C1>4:88<9@<AC:C|F080P @8@P 0D@D|8181P|@:P:>9;8958391;0>|E080P >P0A 5F?8|B0P08<8|H080P9<BPB8|F080P@8@P|"
    "HBDAJ>N9P5N1J0D1>4:98>:A>BD|E080P8P<O>M?J>F<D8C0C|HBDAJ>N9P5N1J0D1>4:98>:A>BD ;>B6|E080P8P<O>M?J>F<D8C0C 7C?8|"
    "F=N;P7P4O2M1J2G5E8D<C?A@>?;<988491;|F0P@P 888P|F0P0@1<4988<9?<@@@P|F0P88@P|J0P58:L?8DP|E0P?8 ?P08|F0P8D@P 888D|E0P>P08?8|"
    "<6S1S1363|B0S<5|;0S5S5303|B0G6P<G|F04@4|:0P4K|C=@<D:G6H3G1D0@1<3968:9<<=@ =8=H|C080P =@<D:G6H3G1D0@1<3968:9<<=@|"
    "B<F9H5H2F0B0>2:5898<:|C=8=P =@<D:G6H3G1D0@1<3968:9<<=@|C0@=@<D:G7H4G1E0A0=2:5888;:|@:P8P6O4M4K48 0H:H|"
    "C=@<D:G6H3G1D0@1<3968:9<<=@ =H=6<3:1704123|C080P 0B1E3G6H:G<E=B=8|7181H 1N1N|;5H5452412000 5N5N|B080P ;H0> 4B<8|:1P1;2948|"
    "J080H 0C1F3G5H8G9F:C:8 :C;F<G?HBGCFDCD8|C080H 0B1E3G6H:G<E=B=8|D>@=D:G7H4G1D0@1<3978:9=<>@|C000H =@<D:G6H3G1D0@1<3968:9<<=@|"
    "C=0=H =@<D:G6H3G1D0@1<3968:9<<=@|?080H 0A1D3G6H9H|B:G8H5H3G1F1D2B4@6@9?;><<;:9968391:|@4N4=4;6988:8 0H:H|"
    "C0H0?1;3968:9<;=> =8=H|B0H68<H|H0H589F=8BH|B0H<8 <H08|B0H68 <H684300|B0H<H08<8|>8S5R4O4F1C4@475483|8131S|=0S3R4O4F7C4@473403|"
    "F0@1C3D4E6D8C8@9?<>>??@@C|";

std::string_view glyph_of(char c) {
  std::string_view rest = kGlyphs;
  for (int i = (c < ' ' || c > '~' ? '?' : c) - ' '; i > 0; --i) rest.remove_prefix(rest.find('|') + 1);
  return rest.substr(0, rest.find('|'));
}

void blend(ColorImage* image, int u, int v, Rgb color, double cover) {
  auto* pixel =
      image->pixels.data() + 3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(image->width) + static_cast<std::size_t>(u));
  for (std::size_t i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(std::lround(pixel[i] + cover * (color[i] - pixel[i])));
}

/// The integers from `low` to `high` that are in [0, size), as a range that is empty when first > last.
std::pair<int, int> clipped(double low, double high, int size) {
  return {static_cast<int>(std::ceil(std::max(low, 0.0))), static_cast<int>(std::floor(std::min(high, size - 1.0)))};
}

}  // namespace

ColorImage blank_image(int width, int height, Rgb background) {
  ColorImage image{{}, width, height};
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = background[i % 3];
  return image;
}

void draw_line(ColorImage* image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, Rgb color, double width_px) {
  if (!from.allFinite() || !to.allFinite()) return;
  const Eigen::Vector2d along = to - from;
  const double length2 = along.squaredNorm(), reach = width_px / 2 + 0.5;
  const auto nearest = [&](double t) -> Eigen::Vector2d { return from + std::clamp(t, 0.0, 1.0) * along; };
  const auto [top, bottom] = clipped(std::min(from.y(), to.y()) - reach, std::max(from.y(), to.y()) + reach, image->height);
  for (int v = top; v <= bottom; ++v) {
    // Where the line passes within reach of this row.
    double left = from.x(), right = to.x();
    if (along.y() != 0) {
      left = nearest((v - reach - from.y()) / along.y()).x();
      right = nearest((v + reach - from.y()) / along.y()).x();
    }
    const auto [first, last] = clipped(std::min(left, right) - reach, std::max(left, right) + reach, image->width);
    for (int u = first; u <= last; ++u) {
      const Eigen::Vector2d pixel(u, v);
      const double distance = (pixel - nearest(length2 > 0 ? (pixel - from).dot(along) / length2 : 0)).norm();
      if (distance < reach) blend(image, u, v, color, std::min(1.0, reach - distance));
    }
  }
}

void draw_rectangle(ColorImage* image, int u, int v, int width, int height, Rgb color) {
  const auto [top, bottom] = clipped(v, v + height - 1.0, image->height);
  const auto [left, right] = clipped(u, u + width - 1.0, image->width);
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) blend(image, x, y, color, 1);
  }
}

void draw_text(ColorImage* image, int u, int v, std::string_view text, double height_px, Rgb color) {
  const double scale = height_px / kGlyphHeight, width_px = std::max(1.0, height_px / 11);
  double pen = u;
  for (const char c : text) {
    const std::string_view glyph = glyph_of(c);
    const auto point = [&](std::size_t i) -> Eigen::Vector2d {
      return {pen + scale * (glyph[i] - '0'), v - scale * (glyph[i + 1] - '0' - kGlyphDescent)};
    };
    for (std::size_t i = 1; i + 3 < glyph.size(); i += 2) {
      if (glyph[i + 2] == ' ')
        ++i;  // on to the next stroke
      else
        draw_line(image, point(i), point(i + 2), color, width_px);
    }
    pen += scale * (glyph[0] - '0');
  }
}

int text_width(std::string_view text, double height_px) {
  double width = 0;
  for (const char c : text) width += glyph_of(c)[0] - '0';
  return static_cast<int>(std::lround(width * height_px / kGlyphHeight));
}

}  // namespace camloc::tools
