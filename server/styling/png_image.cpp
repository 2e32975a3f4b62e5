#include "styling/png_image.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <vector>

#include "base/check.h"
#include "styling/map.h"

namespace mane::styling {
namespace {

// libpng leaves by longjmp. It does so out of Fail() only, through frames of its own and of the
// callbacks here, to functions here that call setjmp and hold nothing with a destructor.

// What the callbacks know.
struct Stream {
  const png_byte* input = nullptr;
  size_t left = 0;
  std::string* output = nullptr;
  std::array<char, 128> message{};
};

void Fail(png_structp png, png_const_charp message) {
  auto* stream = static_cast<Stream*>(png_get_error_ptr(png));
  std::snprintf(stream->message.data(), stream->message.size(), "%s", message);
  png_longjmp(png, 1);
}

void Ignore(png_structp, png_const_charp) {}

void Read(png_structp png, png_bytep data, size_t size) {
  auto* stream = static_cast<Stream*>(png_get_io_ptr(png));
  if (size > stream->left) Fail(png, "it ends too soon");
  std::memcpy(data, stream->input, size);
  stream->input += size;
  stream->left -= size;
}

bool Append(std::string* output, const png_byte* data, size_t size) noexcept {
  try {
    output->append(reinterpret_cast<const char*>(data), size);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

void Write(png_structp png, png_bytep data, size_t size) {
  auto* stream = static_cast<Stream*>(png_get_io_ptr(png));
  if (!Append(stream->output, data, size)) Fail(png, "out of memory");
}

// Owns libpng's state of reading; `png` is null where there was no memory for it.
struct Reader {
  explicit Reader(Stream& stream)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream, Fail, Ignore)) {
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  png_structp png;
  png_infop info = nullptr;
};

struct Writer {
  explicit Writer(Stream& stream)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &stream, Fail, Ignore)) {
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  png_structp png;
  png_infop info = nullptr;
};

// Samples of a pixel: 1 to 4 channels (grey, alpha; red, green, blue, alpha) of 1 or 2 bytes.
struct Layout {
  int channels = 1;
  bool wide = false;

  [[nodiscard]] double Sample(const png_byte* pixel, int channel) const {
    if (!wide) return pixel[channel] / 255.0;
    return (pixel[2 * channel] * 256 + pixel[2 * channel + 1]) / 65535.0;
  }
  [[nodiscard]] float Value(const png_byte* pixel) const {
    double value = Sample(pixel, 0);
    if (channels >= 3) {
      value = 0.2126 * value + 0.7152 * Sample(pixel, 1) + 0.0722 * Sample(pixel, 2);
    }
    if (channels % 2 == 0) value *= Sample(pixel, channels - 1);
    return static_cast<float>(std::min(value, 1.0));
  }
  [[nodiscard]] size_t pixel_size() const { return size_t(channels) * (wide ? 2 : 1); }
};

// Reads the header and prepares for rows of `layout`.
bool ReadHeader(png_structp png, png_infop info, Layout* layout) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_user_limits(png, kLargestImage, kLargestImage);
  // All that is not needed: what says how numbers become light, and what may be packed bombs.
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(png, info);
  png_set_expand(png);  // Palettes to colours, 1, 2 and 4 bits to 8, transparent colours to alpha.
  png_read_update_info(png, info);
  layout->channels = png_get_channels(png, info);
  layout->wide = png_get_bit_depth(png, info) == 16;
  return true;
}

// Reads all rows, in the passes of an interlaced image, each a coarser image of its own.
bool ReadRows(png_structp png, png_infop info, const Layout& layout, png_bytep row, float* values) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const png_uint_32 width = png_get_image_width(png, info);
  const png_uint_32 height = png_get_image_height(png, info);
  const bool interlaced = png_get_interlace_type(png, info) != PNG_INTERLACE_NONE;
  for (int pass = 0; pass < (interlaced ? PNG_INTERLACE_ADAM7_PASSES : 1); ++pass) {
    const png_uint_32 x0 = interlaced ? PNG_PASS_START_COL(pass) : 0;
    const png_uint_32 y0 = interlaced ? PNG_PASS_START_ROW(pass) : 0;
    const png_uint_32 dx = interlaced ? 1u << PNG_PASS_COL_SHIFT(pass) : 1;
    const png_uint_32 dy = interlaced ? 1u << PNG_PASS_ROW_SHIFT(pass) : 1;
    if (x0 >= width) continue;  // libpng passes over it too.
    for (png_uint_32 y = y0; y < height; y += dy) {
      png_read_row(png, row, nullptr);
      const png_byte* pixel = row;
      for (png_uint_32 x = x0; x < width; x += dx, pixel += layout.pixel_size()) {
        values[size_t(y) * width + x] = layout.Value(pixel);
      }
    }
  }
  png_read_end(png, nullptr);  // The last check sums.
  return true;
}

bool WriteRows(png_structp png, png_infop info, const MapImage* image, png_bytep row) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, info, image->width, image->height, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  const float* value = image->values.data();
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const auto sample = static_cast<uint16_t>(std::lround(*value++ * 65535.0));
      row[2 * x] = static_cast<png_byte>(sample >> 8);
      row[2 * x + 1] = static_cast<png_byte>(sample & 255);
    }
    png_write_row(png, row);
  }
  png_write_end(png, info);
  return true;
}

uint32_t BigEndian(const png_byte* b) {
  return uint32_t(b[0]) << 24 | uint32_t(b[1]) << 16 | uint32_t(b[2]) << 8 | uint32_t(b[3]);
}

// Signature and size, which libpng would refuse in words of its own.
Result<void> CheckStart(std::span<const png_byte> png, const std::string& field, MapImage* image) {
  constexpr size_t kStart = 24;  // Signature, then length, name, width and height of the header.
  if (png.size() < kStart || png_sig_cmp(png.data(), 0, 8) != 0 ||
      std::memcmp(png.data() + 12, "IHDR", 4) != 0) {
    return InvalidArgument(field, fmt::format("{} of {} bytes is no PNG image", field, png.size()));
  }
  const uint32_t width = BigEndian(png.data() + 16), height = BigEndian(png.data() + 20);
  if (std::min(width, height) < 1 || std::max(width, height) > uint32_t(kLargestImage)) {
    return InvalidArgument(field, fmt::format("{} has {} x {} pixels; both must lie in [1, {}]",
                                              field, width, height, kLargestImage));
  }
  image->width = static_cast<int>(width);
  image->height = static_cast<int>(height);
  return {};
}

}  // namespace

Result<MapImage> DecodePng(std::span<const std::byte> png, const std::string& field) {
  Stream stream{reinterpret_cast<const png_byte*>(png.data()), png.size()};
  MapImage image;
  if (auto start = CheckStart({stream.input, stream.left}, field, &image); !start) {
    return start.error();
  }
  const auto broken = [&] {
    return InvalidArgument(
        field, fmt::format("{} is a broken PNG image: {}", field, stream.message.data()));
  };
  Reader reader(stream);
  MANE_CHECK(reader.info != nullptr);
  png_set_read_fn(reader.png, &stream, Read);
  Layout layout;
  if (!ReadHeader(reader.png, reader.info, &layout)) return broken();
  std::vector<png_byte> row(png_get_rowbytes(reader.png, reader.info));
  image.values.resize(size_t(image.width) * image.height);
  if (!ReadRows(reader.png, reader.info, layout, row.data(), image.values.data())) return broken();
  return image;
}

int64_t PixelsOf(std::span<const std::byte> png) {
  constexpr size_t kWidthAt = 16, kHeightAt = 20, kHeaderEnd = 24;  // Of IHDR, big-endian.
  if (png.size() < kHeaderEnd) return 0;
  const auto number = [png](size_t at) {
    int64_t n = 0;
    for (size_t i = at; i < at + 4; ++i) n = 256 * n + std::to_integer<int64_t>(png[i]);
    return n;
  };
  return number(kWidthAt) * number(kHeightAt);
}

std::string EncodePng(const MapImage& image) {
  MANE_CHECK(Validate(image, "image"));
  std::string png;
  Stream stream;
  stream.output = &png;
  Writer writer(stream);
  MANE_CHECK(writer.info != nullptr);
  png_set_write_fn(writer.png, &stream, Write, nullptr);
  std::vector<png_byte> row(2 * size_t(image.width));
  MANE_CHECK(WriteRows(writer.png, writer.info, &image, row.data()));
  return png;
}

}  // namespace mane::styling
