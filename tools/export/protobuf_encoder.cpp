#include "tools/export/protobuf_encoder.hpp"

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/duration.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/timestamp.pb.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/time_util.h>

#include <stdexcept>

#include "tools/export/foxglove_schemas.hpp"

namespace palpate::exporting {
namespace {

namespace pb = google::protobuf;
using Json = nlohmann::ordered_json;
using Kind = FoxgloveField::Kind;
using Field = pb::FieldDescriptorProto;

void describe(const FoxgloveField& field, const FoxgloveMessage& owner, Field& out) {
  out.set_name(field.name);
  out.set_label(field.is_list ? Field::LABEL_REPEATED : Field::LABEL_OPTIONAL);
  const auto refer = [&out](Field::Type type, const std::string& name) {
    out.set_type(type);
    out.set_type_name(name);
  };
  switch (field.kind) {
    case Kind::kDouble:
      return out.set_type(Field::TYPE_DOUBLE);
    case Kind::kFixed32:
      return out.set_type(Field::TYPE_FIXED32);
    case Kind::kFlag:
      return out.set_type(Field::TYPE_BOOL);
    case Kind::kText:
      return out.set_type(Field::TYPE_STRING);
    case Kind::kBytes:
      return out.set_type(Field::TYPE_BYTES);
    case Kind::kTime:
      return refer(Field::TYPE_MESSAGE, ".google.protobuf.Timestamp");
    case Kind::kDuration:
      return refer(Field::TYPE_MESSAGE, ".google.protobuf.Duration");
    case Kind::kChoice:
      return refer(Field::TYPE_ENUM, std::string(".foxglove.") + owner.name + "." + owner.choice);
    case Kind::kMessage:
      return refer(Field::TYPE_MESSAGE, std::string(".foxglove.") + field.message);
  }
}

pb::FileDescriptorProto description() {
  pb::FileDescriptorProto file;
  file.set_name("foxglove.proto");
  file.set_package("foxglove");
  file.set_syntax("proto3");
  file.add_dependency(pb::Timestamp::descriptor()->file()->name());
  file.add_dependency(pb::Duration::descriptor()->file()->name());
  for (const FoxgloveMessage& message : foxglove_messages()) {
    pb::DescriptorProto& out = *file.add_message_type();
    out.set_name(message.name);
    for (const FoxgloveField& field : message.fields) {
      Field& described = *out.add_field();
      described.set_number(out.field_size());
      describe(field, message, described);
    }
    if (message.choice == nullptr) continue;
    pb::EnumDescriptorProto& choice = *out.add_enum_type();
    choice.set_name(message.choice);
    for (const char* name : message.values) {
      pb::EnumValueDescriptorProto& value = *choice.add_value();
      value.set_name(name);
      value.set_number(choice.value_size() - 1);
    }
  }
  return file;
}

/// Times of our JSON, {sec, nsec}, as the texts that Protobuf's JSON has for them.
void convert_times(const pb::Descriptor& type, Json& message) {
  for (int i = 0; i < type.field_count(); ++i) {
    const pb::FieldDescriptor& field = *type.field(i);
    const auto value = message.find(field.name());
    if (value == message.end() || field.message_type() == nullptr) continue;
    const pb::Descriptor& part = *field.message_type();
    const bool is_time = part.full_name() == "google.protobuf.Timestamp";
    if (is_time || part.full_name() == "google.protobuf.Duration") {
      const std::int64_t us = value->at("sec").get<std::int64_t>() * 1'000'000 +
                              value->at("nsec").get<std::int64_t>() / 1000;
      *value = is_time
                   ? pb::util::TimeUtil::ToString(pb::util::TimeUtil::MicrosecondsToTimestamp(us))
                   : pb::util::TimeUtil::ToString(pb::util::TimeUtil::MicrosecondsToDuration(us));
    } else if (field.is_repeated()) {
      for (Json& one : *value) convert_times(part, one);
    } else {
      convert_times(part, *value);
    }
  }
}

}  // namespace

struct ProtobufEncoder::Impl {
  pb::DescriptorPool pool{pb::DescriptorPool::generated_pool()};
  pb::DynamicMessageFactory factory{&pool};
};

ProtobufEncoder::ProtobufEncoder() : impl_(std::make_unique<Impl>()) {
  pb::FileDescriptorSet set;
  pb::Timestamp::descriptor()->file()->CopyTo(set.add_file());
  pb::Duration::descriptor()->file()->CopyTo(set.add_file());
  *set.add_file() = description();
  if (impl_->pool.BuildFile(description()) == nullptr)
    throw std::logic_error("the description of Foxglove's messages contradicts itself");
  descriptions_ = set.SerializeAsString();
}

ProtobufEncoder::~ProtobufEncoder() = default;

std::string ProtobufEncoder::encode(const std::string& schema, const std::string& json) {
  const pb::Descriptor* type = impl_->pool.FindMessageTypeByName(schema);
  if (type == nullptr) throw std::runtime_error("no Foxglove schema " + schema);
  Json converted = Json::parse(json);
  convert_times(*type, converted);
  const std::unique_ptr<pb::Message> message(impl_->factory.GetPrototype(type)->New());
  const auto status = pb::util::JsonStringToMessage(converted.dump(), message.get());
  if (!status.ok()) throw std::runtime_error(schema + ": " + std::string(status.message()));
  return message->SerializeAsString();
}

}  // namespace palpate::exporting
