// A 5x7 bitmap font of the printable ASCII characters, drawn for this project, so that text on images needs
// no font file or library.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace motiongan::view {

/// Pixels of a character at scale 1.
/// \{
inline constexpr std::size_t glyph_width = 5;
inline constexpr std::size_t glyph_height = 7;
/// \}
inline constexpr std::size_t line_height = 9;    ///< including the descenders of g, p, q and y
inline constexpr std::size_t glyph_advance = 6;  ///< pixels from one character to the next at scale 1

/// One character: 7 rows of 5 bits, top row in the highest bits, leftmost pixel in the highest bit of its
/// row.
using Glyph = std::uint64_t;

/// Characters 32 (space) to 126 (tilde).
inline constexpr std::array<Glyph, 95> font_5x7 = {
    0x000000000, 0x108421004, 0x294000000, 0x295f57d4a, 0x11f4717c4, 0x672222273, 0x32544564d,  // !"#$%&
    0x108000000, 0x088842082, 0x208210888, 0x009575480, 0x0084f9080, 0x000001888, 0x000070000,  // '()*+,-
    0x00000018c, 0x002222200, 0x3a33ae62e, 0x11842108e, 0x3a211111f, 0x7c441062e, 0x08ca97c42,  // ./01234
    0x7e1e0862e, 0x1910f462e, 0x7c2221108, 0x3a317462e, 0x3a317844c, 0x018c03180, 0x00c601888,  // 56789:;
    0x088882082, 0x001f07c00, 0x208208888, 0x3a2111004, 0x3a37ade0f, 0x3a31fc631, 0x7a31f463e,  // <=>?@AB
    0x3a308422e, 0x7a318c63e, 0x7e10f421f, 0x7e10f4210, 0x3a30bc62e, 0x4631fc631, 0x38842108e,  // CDEFGHI
    0x1c4210a4c, 0x4654c5251, 0x42108421f, 0x4775ac631, 0x4735ace31, 0x3a318c62e, 0x7a31f4210,  // JKLMNOP
    0x3a318d64d, 0x7a31f5251, 0x3e107043e, 0x7c8421084, 0x46318c62e, 0x46318a944, 0x4631ad771,  // QRSTUVW
    0x462a22a31, 0x462a21084, 0x7c222221f, 0x39084210e, 0x020820820, 0x38421084e, 0x115100000,  // XYZ[\ ]^
    0x00000001f, 0x208000000, 0x000e0be2f, 0x4216cc63e, 0x000e8422e, 0x042d9c62f, 0x000e8fe0e,  // _`abcde
    0x1928e2108, 0x36718bc2e, 0x4216cc631, 0x100c2108e, 0x080610a4c, 0x4212a6292, 0x30842108e,  // fghijkl
    0x001aad6b5, 0x0016cc631, 0x000e8c62e, 0x5b318fa10, 0x36718bc21, 0x0016cc210, 0x000f8383e,  // mnopqrs
    0x211c42126, 0x00118c66d, 0x00118c544, 0x0011ad6aa, 0x001151151, 0x46318bc2e, 0x001f1111f,  // tuvwxyz
    0x0c8441083, 0x108421084, 0x608411098, 0x0008a8800,                                         // {|}~
};

/// The glyph of `c`; a question mark if `c` is not printable ASCII.
inline constexpr Glyph glyph(char c) {
  const auto code = static_cast<unsigned char>(c);
  return font_5x7[code >= 32 && code < 127 ? code - 32u : '?' - 32u];
}

/// Pixels by which a character is lowered: the descenders of g, p, q and y go below the baseline.
inline constexpr std::size_t glyph_drop(char c) {
  return c == 'g' || c == 'p' || c == 'q' || c == 'y' ? 2 : 0;
}

/// Whether the pixel in column `x` (0..4) and row `y` (0..6) of a glyph is set.
inline constexpr bool glyph_pixel(Glyph g, std::size_t x, std::size_t y) {
  return (g >> ((glyph_height - 1 - y) * glyph_width + (glyph_width - 1 - x)) & 1u) != 0;
}

/// `utf8` as printable ASCII, with a question mark for each character that is not in the font.
inline std::string printable(std::string_view utf8) {
  std::string out;
  for (const char c : utf8) {
    const auto code = static_cast<unsigned char>(c);
    if ((code & 0xc0u) == 0x80u) continue;  // continuation byte of a character already handled
    out += code >= 32 && code < 127 ? c : (c == '\t' || c == '\n' ? ' ' : '?');
  }
  return out;
}

}  // namespace motiongan::view
