#include <algorithm>

#include "tools/view/viewer.hpp"

namespace palpate::view {

using nlohmann::json;

bool Viewer::receive(const std::shared_ptr<serve::Client>& client, const std::string& text,
                     std::int64_t now_us) {
  try {
    const Request request = parse_request(text, options_.max_force);
    if (moves_something(request) && !client->may_control)
      throw RequestError(options_.control ? "commands need the token that palpate-view printed"
                                          : "palpate-view runs without --control: reading only");
    return carry_out(client, request, now_us);
  } catch (const RequestError& error) {
    client->send_text(serve::dump({{"type", "error"}, {"reason", error.what()}}));
    return true;
  }
}

bool Viewer::carry_out(const std::shared_ptr<serve::Client>& client, const Request& request,
                       std::int64_t now_us) {
  if (const auto* r = std::get_if<Acknowledge>(&request)) {
    client->acknowledged = std::max(client->acknowledged, std::min(r->frame, frames_));
  } else if (const auto* colour = std::get_if<ColourBy>(&request)) {
    static_cast<ViewerClient&>(*client).field = colour->field;
  } else if (const auto* take = std::get_if<TakeControl>(&request)) {
    grant(*client, *take);
    return client->wrong_tokens < serve::kMostWrongTokens;
  } else if (const auto* command = std::get_if<Command>(&request)) {
    daemon_->ask(command->message, now_us, answer_to(client, command->id));
  } else if (const auto* target = std::get_if<SetTarget>(&request)) {
    daemon_->ask(target->message, now_us, answer_to(client, target->id));
  } else if (const auto* push = std::get_if<Push>(&request)) {
    double point[3], force[3];
    std::copy_n(push->rest_point.begin(), 3, point);
    std::copy_n(push->force.begin(), 3, force);
    daemon_->apply_force(point, force, now_us);
  } else if (const auto* p = std::get_if<Play>(&request)) {
    play(*p);
  }
  return true;
}

void Viewer::grant(serve::Client& client, const TakeControl& request) {
  const bool right = options_.control && daemon_ && token_.is(request.token);
  client.may_control = right;
  if (options_.control && !right) ++client.wrong_tokens;
  const char* reason = right              ? ""
                       : options_.control ? "wrong token"
                                          : "palpate-view runs without --control";
  client.send_text(serve::dump({{"type", "control"}, {"granted", right}, {"reason", reason}}));
}

client::Client::OnAnswer Viewer::answer_to(const std::shared_ptr<serve::Client>& client,
                                           std::int64_t id) const {
  // The page may have disconnected by then.
  return [weak = std::weak_ptr<serve::Client>(client), id](const client::Answer& answer) {
    const auto to = weak.lock();
    if (!to || !to->send_text) return;
    to->send_text(serve::dump({{"type", "answer"},
                               {"id", id},
                               {"event", answer.event},
                               {"reason", answer.reason},
                               {"last", answer.last}}));
  };
}

void Viewer::play(const Play& request) {
  if (!log_) return;
  switch (request.action) {
    case Play::Action::kPlay:
      if (log_->time() >= log_->duration()) log_->go_to(0, scene_);
      playing_ = true;
      break;
    case Play::Action::kPause:
      playing_ = false;
      break;
    case Play::Action::kSeek:
      log_->go_to(request.value, scene_);
      break;
    case Play::Action::kRate:
      rate_ = request.value;
      break;
  }
}

}  // namespace palpate::view
