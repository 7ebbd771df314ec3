#include "tools/import/encoder.hpp"

#include <cmath>
#include <limits>
#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <stdexcept>

#include "core/math/rigid.hpp"

namespace palpate::import {
namespace {

/// fill(csv, mapping, message) writes the fields after the head.
template <class Message, class Fill>
class EncoderOf : public Encoder {
 public:
  EncoderOf(FieldMapping mapping, Fill fill) : mapping_(std::move(mapping)), fill_(fill) {}

  std::vector<std::uint8_t> encode(const recordings::CsvReader& csv,
                                   const MessageHead& head) const override {
    Message message{};
    message.utime = head.utime;
    message.seq = head.seq;
    message.session = head.session;
    fill_(csv, mapping_, message);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0)
      csv.fail("the message could not be encoded");
    return bytes;
  }

  const FieldMapping& mapping() const override { return mapping_; }

 private:
  FieldMapping mapping_;
  Fill fill_;
};

template <class Message, class Fill>
std::unique_ptr<Encoder> encoder_of(FieldMapping mapping, Fill fill) {
  return std::make_unique<EncoderOf<Message, Fill>>(std::move(mapping), fill);
}

std::int16_t counts(const recordings::CsvReader& csv, const FieldMapping& mapping, int field) {
  const double value = std::round(mapping.value(csv, field));
  using Limits = std::numeric_limits<std::int16_t>;
  if (value < Limits::min() || value > Limits::max())
    csv.fail(mapping.column(field), "does not fit 16 bits");
  return static_cast<std::int16_t>(value);
}

// Indices into the lists of fields.cpp.
constexpr int kQuaternion = 3, kTwist = 7, kJoints = 13, kSpeeds = 29, kEfforts = 45;
constexpr int kMaxJoints = 16;
constexpr int kPac = 19, kPdc = 41, kTac = 42, kTdc = 43;
constexpr int kElectrodes = 19, kPacSlots = 22;

void fill_robot_state(const recordings::CsvReader& csv, const FieldMapping& mapping,
                      robot_state_t& message) {
  message.joint_count = 1;
  for (int i = 0; i < kMaxJoints; ++i) {
    if (mapping.has(kJoints + i)) message.joint_count = i + 1;
    message.q[i] = mapping.value(csv, kJoints + i);
    message.dq[i] = mapping.value(csv, kSpeeds + i);
    message.tau[i] = mapping.value(csv, kEfforts + i);
  }
  for (int i = 0; i < 3; ++i) message.position[i] = mapping.value(csv, i);
  for (int i = 0; i < 4; ++i) message.quaternion[i] = mapping.value(csv, kQuaternion + i);
  for (int i = 0; i < 6; ++i) message.twist[i] = mapping.value(csv, kTwist + i);
  if (!math::is_unit_quaternion(message.quaternion))
    csv.fail("the quaternion is not of unit length");
}

void fill_biotac(const recordings::CsvReader& csv, const FieldMapping& mapping, biotac_t& message) {
  if (mapping.has(0)) message.valid |= biotac_t::VALID_ELECTRODES;
  if (mapping.has(kPac)) message.valid |= biotac_t::VALID_PAC;
  if (mapping.has(kPdc)) message.valid |= biotac_t::VALID_PDC;
  if (mapping.has(kTac) && mapping.has(kTdc)) message.valid |= biotac_t::VALID_TEMPERATURE;
  for (int i = 0; i < kElectrodes; ++i) message.electrodes[i] = counts(csv, mapping, i);
  message.pac_count = 0;
  for (int i = 0; i < kPacSlots && mapping.has(kPac + i); ++i) {
    message.pac[i] = counts(csv, mapping, kPac + i);
    message.pac_count = static_cast<std::int16_t>(i + 1);
  }
  message.pdc = counts(csv, mapping, kPdc);
  message.tac = counts(csv, mapping, kTac);
  message.tdc = counts(csv, mapping, kTdc);
}

}  // namespace

std::unique_ptr<Encoder> make_encoder(const std::string& format,
                                      const std::map<std::string, std::string>& described,
                                      const recordings::CsvReader& csv) {
  FieldMapping mapping(format, described, csv);
  if (format == "force_torque") {
    return encoder_of<ft_wrench_t>(
        std::move(mapping),
        [](const recordings::CsvReader& row, const FieldMapping& from, ft_wrench_t& to) {
          for (int i = 0; i < 6; ++i) to.wrench[i] = from.value(row, i);
        });
  }
  if (format == "imu") {
    return encoder_of<imu_t>(std::move(mapping), [](const recordings::CsvReader& row,
                                                    const FieldMapping& from, imu_t& to) {
      for (int i = 0; i < 3; ++i) to.acceleration[i] = from.value(row, i);
      for (int i = 0; i < 3; ++i) to.angular_velocity[i] = from.value(row, 3 + i);
    });
  }
  if (format == "robot_state")
    return encoder_of<robot_state_t>(std::move(mapping), fill_robot_state);

  for (int i = 1; i < kElectrodes; ++i)
    if (mapping.has(i) != mapping.has(0))
      throw std::invalid_argument("a biotac needs all of e1 to e19, or none");
  if (!mapping.has_any(0, kTdc + 1))
    throw std::invalid_argument("none of the columns is a biotac's (e1 to e19, pac0, pdc, ...)");
  return encoder_of<biotac_t>(std::move(mapping), fill_biotac);
}

}  // namespace palpate::import
