// Pose packets as docs/formats.md describes them, written apart from the code that reads them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace bodyopt::testing {

struct PacketFields {
  std::string magic = "BPOS";
  std::uint16_t version = 1, flags = 0;
  std::uint32_t number = 0;
  std::int32_t frame = 0;
  std::uint16_t joint_count = 0, control_count = 0;
  std::vector<float> values;  // joints, then controls
};

// Joints at the origin, unturned.
inline PacketFields packet_fields(std::uint16_t joints, std::uint16_t controls) {
  PacketFields fields;
  fields.joint_count = joints;
  fields.control_count = controls;
  for (int j = 0; j < joints; ++j) {
    fields.values.insert(fields.values.end(), {0, 0, 0, /* rotation */ 0, 0, 0, 1, /* scale */ 1, 1, 1});
  }
  fields.values.resize(fields.values.size() + controls);
  return fields;
}

inline std::string packet_bytes(const PacketFields& fields) {
  std::string bytes = fields.magic;
  const auto append = [&](std::uint64_t value, int count) {
    for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> 8 * k & 0xff);
  };
  append(fields.version, 2);
  append(fields.flags, 2);
  append(fields.number, 4);
  append(static_cast<std::uint32_t>(fields.frame), 4);
  append(fields.joint_count, 2);
  append(fields.control_count, 2);
  for (const float value : fields.values) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    append(bits, 4);
  }
  return bytes;
}

}  // namespace bodyopt::testing
