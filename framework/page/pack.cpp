#include "framework/page/pack.h"

#include <openssl/evp.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json coordinate(const Json& values, const Json& earlier, const Json& columns, std::size_t j) {
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c]["values"] == values) return {{"column", c}};
  Json own = packed(values);
  for (std::size_t i = 0; i < earlier.size(); ++i)
    if (const Json& list = earlier[i]["coordinates"]; j < list.size() && list[j] == own)
      return {{"state", i}, {"coordinate", j}};
  return own;
}

}  // namespace

Json packed(const Json& values) {
  std::vector<unsigned char> bytes;
  for (const Json& v : values) {
    const auto bits = std::bit_cast<std::uint32_t>(
        v.is_number() ? v.get<float>() : std::numeric_limits<float>::quiet_NaN());
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<unsigned char>(bits >> shift & 255));
  }
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // and the zero that ends it
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                  static_cast<int>(bytes.size()));
  text.pop_back();
  return {{"f32", text}};
}

void pack(Json& state, const Json& earlier, const Json& columns) {
  Json& coordinates = state["coordinates"];
  for (std::size_t j = 0; j < coordinates.size(); ++j)
    coordinates[j] = coordinate(coordinates[j], earlier, columns, j);
  for (Json& row : state["rows"])
    if (row.contains("residuals")) row["residuals"] = packed(row["residuals"]);
  if (state.contains("offsets"))
    for (Json& lists : state["offsets"])
      for (Json& list : lists) list = packed(list);
}

}  // namespace talus
