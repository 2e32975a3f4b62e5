// PNG images:
//   round trip  a map comes back within half a step of 16 bits, and its bytes are always the same
//   kinds       grey of 1 to 16 bits, palettes, colours, alpha, interlaced: as the header says, in
//               images written by libpng itself
//   meaning     samples count as they are stored, whatever gamma the file claims
//   hostile     any cut, any changed byte, absurd sizes: an error that names the field, or an image
//               where what was changed does not matter

#include "styling/png_image.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <string>
#include <vector>

#include "math/random.h"

namespace mane::styling {
namespace {

std::span<const std::byte> Bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

MapImage Noise(int width, int height, uint64_t seed) {
  MapImage image{width, height, std::vector<float>(size_t(width) * height)};
  math::RandomStream random(seed, 0);
  for (float& value : image.values) value = static_cast<float>(random.Uniform());
  return image;
}

struct Kind {
  int bits = 8;
  int color = PNG_COLOR_TYPE_GRAY;
  int interlace = PNG_INTERLACE_NONE;
  double gamma = 0;
  std::vector<png_color> palette{};
  std::vector<png_byte> palette_alpha{};
};

// Writes packed rows of `row_bytes` each.
std::string Write(int width, int height, const Kind& kind, std::vector<png_byte> data) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep bytes, size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(bytes), size);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, kind.bits, kind.color, kind.interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (kind.gamma > 0) png_set_gAMA(png, info, kind.gamma);
  if (!kind.palette.empty()) {
    png_set_PLTE(png, info, kind.palette.data(), static_cast<int>(kind.palette.size()));
  }
  if (!kind.palette_alpha.empty()) {
    png_set_tRNS(png, info, kind.palette_alpha.data(), static_cast<int>(kind.palette_alpha.size()),
                 nullptr);
  }
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) rows.push_back(data.data() + y * (data.size() / height));
  png_set_rows(png, info, rows.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

void ExpectValues(const std::string& png, const std::vector<double>& expected) {
  const Result<MapImage> image = DecodePng(Bytes(png), "map");
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->values.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(image->values[i], expected[i], 1e-7) << i;
  }
}

void ExpectError(const std::string& png, const std::string& words) {
  const Result<MapImage> image = DecodePng(Bytes(png), "maps.length");
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(image.error().field, "maps.length");
  EXPECT_NE(image.error().message.find("maps.length"), std::string::npos);
  EXPECT_NE(image.error().message.find(words), std::string::npos) << image.error().message;
}

TEST(PngImageTest, MapsComeBack) {
  for (const auto& [width, height] : {std::pair(1, 1), {37, 20}, {256, 3}, {1, 4096}}) {
    const MapImage image = Noise(width, height, 3);
    const std::string png = EncodePng(image);
    EXPECT_EQ(png, EncodePng(image));
    const Result<MapImage> back = DecodePng(Bytes(png), "map");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->width, width);
    EXPECT_EQ(back->height, height);
    for (size_t i = 0; i < image.values.size(); ++i) {
      EXPECT_NEAR(back->values[i], image.values[i], 0.5 / 65535 + 1e-7);
    }
    EXPECT_EQ(EncodePng(*back), png);
  }
}

TEST(PngImageTest, GreyOfAllDepths) {
  ExpectValues(Write(3, 1, {8}, {0, 51, 255}), {0, 0.2, 1});
  ExpectValues(Write(2, 1, {16}, {0x33, 0x33, 0xff, 0xff}), {0.2, 1});
  ExpectValues(Write(4, 1, {1}, {0b01100000}), {0, 1, 1, 0});
  ExpectValues(Write(4, 1, {2}, {0b00011011}), {0, 1 / 3.0, 2 / 3.0, 1});
  ExpectValues(Write(2, 1, {4}, {0x3f}), {0.2, 1});
}

TEST(PngImageTest, ColoursBecomeTheirLuma) {
  ExpectValues(Write(4, 1, {8, PNG_COLOR_TYPE_RGB}, {255, 0, 0, 0, 255, 0, 0, 0, 255, 51, 51, 51}),
               {0.2126, 0.7152, 0.0722, 0.2});
  ExpectValues(Write(1, 1, {16, PNG_COLOR_TYPE_RGB}, {0xff, 0xff, 0, 0, 0x33, 0x33}),
               {0.2126 + 0.2 * 0.0722});
  Kind palette{2, PNG_COLOR_TYPE_PALETTE};
  palette.palette = {{0, 0, 0}, {255, 255, 255}, {0, 255, 0}};
  palette.palette_alpha = {255, 102};
  ExpectValues(Write(3, 1, palette, {0b00011000}), {0, 0.4, 0.7152});
}

TEST(PngImageTest, WhatIsTransparentIsBlack) {
  ExpectValues(Write(3, 1, {8, PNG_COLOR_TYPE_GRAY_ALPHA}, {255, 255, 255, 51, 255, 0}),
               {1, 0.2, 0});
  ExpectValues(
      Write(1, 1, {16, PNG_COLOR_TYPE_RGB_ALPHA}, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x33, 0x33}),
      {0.2});
}

TEST(PngImageTest, SamplesCountWhateverGammaTheFileClaims) {
  for (const int bits : {8, 16}) {
    Kind kind{bits};
    kind.gamma = 1.0;
    ExpectValues(Write(1, 1, kind,
                       bits == 8 ? std::vector<png_byte>{51} : std::vector<png_byte>{0x33, 0x33}),
                 {0.2});
  }
}

TEST(PngImageTest, InterlacedImagesAreTheSame) {
  math::RandomStream random(4, 0);
  for (int width = 1; width <= 19; ++width) {
    for (int height = 1; height <= 12; ++height) {
      std::vector<png_byte> data(size_t(3) * width * height);
      for (png_byte& b : data) b = static_cast<png_byte>(random.Bits());
      Kind kind{8, PNG_COLOR_TYPE_RGB};
      const Result<MapImage> plain = DecodePng(Bytes(Write(width, height, kind, data)), "map");
      kind.interlace = PNG_INTERLACE_ADAM7;
      const Result<MapImage> laced = DecodePng(Bytes(Write(width, height, kind, data)), "map");
      ASSERT_TRUE(plain && laced);
      EXPECT_EQ(plain->values, laced->values) << width << " x " << height;
    }
  }
}

TEST(PngImageTest, EveryCutIsAnError) {
  const std::string png = EncodePng(Noise(9, 7, 5));
  for (size_t size = 0; size < png.size(); ++size) {
    const Result<MapImage> image = DecodePng(Bytes(png.substr(0, size)), "map");
    EXPECT_FALSE(image) << size;
  }
  ExpectError(png.substr(0, 20), "no PNG");
  ExpectError(png.substr(0, png.size() - 5), "too soon");
  ExpectError("", "no PNG");
  ExpectError(std::string(100, 'x'), "no PNG");
}

TEST(PngImageTest, EveryChangedByteIsAnErrorOrDoesNotMatter) {
  const MapImage original = Noise(9, 7, 6);
  const std::string png = EncodePng(original);
  const Result<MapImage> whole = DecodePng(Bytes(png), "map");
  int read = 0;
  for (size_t i = 0; i < png.size(); ++i) {
    for (const int change : {1, 0x20, 0xff}) {
      std::string changed = png;
      changed[i] = static_cast<char>(changed[i] ^ change);
      const Result<MapImage> image = DecodePng(Bytes(changed), "map");
      if (!image) continue;
      EXPECT_EQ(image->values, whole->values) << i;
      ++read;
    }
  }
  // What libpng forgives: check sums of chunks behind the image at most.
  EXPECT_LT(read, 20);
}

TEST(PngImageTest, AWrongCheckSumIsNamed) {
  std::string png = EncodePng(Noise(9, 7, 7));
  png[29] = static_cast<char>(png[29] ^ 1);  // Of the header.
  ExpectError(png, "CRC");
  png[29] = static_cast<char>(png[29] ^ 1);
  png[png.size() - 13] = static_cast<char>(png[png.size() - 13] ^ 1);  // Of the pixels.
  ExpectError(png, "CRC");
}

TEST(PngImageTest, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  std::string png = EncodePng(Noise(9, 7, 8));
  png[16] = '\x7f';
  ExpectError(png, "2130706441 x 7 pixels");
  png[16] = 0;
  png[19] = 0;
  ExpectError(png, "0 x 7 pixels");
  ExpectError(Write(4097, 1, {1}, std::vector<png_byte>(513)), "4097 x 1");
  const Result<MapImage> largest =
      DecodePng(Bytes(Write(4096, 1, {1}, std::vector<png_byte>(512, 0xff))), "map");
  ASSERT_TRUE(largest);
  EXPECT_EQ(largest->values[4095], 1);
}

TEST(PngImageTest, PixelsAreToldBeforeTheyAreDecoded) {
  const std::string png = EncodePng({7, 3, std::vector<float>(21)});
  EXPECT_EQ(PixelsOf(std::as_bytes(std::span(png))), 21);
  EXPECT_EQ(PixelsOf(std::as_bytes(std::span(png).first(20))), 0);
}

}  // namespace
}  // namespace mane::styling
