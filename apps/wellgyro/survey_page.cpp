#include "survey_page.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <ctime>
#include <exception>
#include <system_error>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/io/result/survey_json.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/page/live_page.h"

#include "live.h"
#include "orders.h"

namespace wellgyro::apps {
namespace {

namespace fs = std::filesystem;

// What comes within it goes out together: a page is woken five times a second at most.
constexpr std::int64_t kTogetherUs = 200'000;
// Between two looks at the files of the survey, which may take a hundredth of a core at most.
constexpr std::int64_t kLookUs = 1'000'000, kLookShare = 100;

/// The folders of the survey's results, by the name that tells the tools apart.
std::vector<std::pair<std::string, fs::path>> PartsOf(const fs::path& folder) {
  std::vector<std::pair<std::string, fs::path>> parts;
  std::error_code absent;
  if (fs::exists(folder / "run.toml", absent)) parts.emplace_back("", folder);
  for (fs::directory_iterator entry(folder, absent), end; !absent && entry != end;
       entry.increment(absent)) {
    std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (!name.starts_with("tool-") || !fs::exists(entry->path() / "run.toml", ignored)) continue;
    parts.emplace_back(std::move(name), entry->path());
  }
  std::ranges::sort(parts);
  return parts;
}

Result<std::optional<OtherWell>> PlanIn(const std::string& path) {
  if (path.empty()) return std::optional<OtherWell>();
  Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return std::optional(OtherWell{fs::path(path).stem().string(), *std::move(text)});
}

/// False where `text` is there and no number.
template <class Number>
bool Read(const std::string& text, Number& number) {
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return text.empty() || (error == std::errc() && rest == text.data() + text.size());
}

/// Of a processor, that the calling thread has used [us].
std::int64_t UsedUs() {
  timespec used{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return used.tv_sec * 1'000'000 + used.tv_nsec / 1000;
}

/// What those who look must bring: of the file, which is made where it is not there, or a new one.
Result<std::string> TokenBy(const SurveyPageOptions& options) {
  std::string token = options.token_file.empty() ? NewToken() : TokenIn(options.token_file);
  if (!token.empty()) return token;
  return Fault{.code = FaultCode::kIo,
               .text = "--page-token: no token of 16 letters and digits can be had there",
               .source = options.token_file};
}

/// The address that the page is to be served at.
Result<PageAddress> AddressBy(const SurveyPageOptions& options) {
  const auto address = PageAddressOf(options.address);
  if (address) return *address;
  return Fault{.code = FaultCode::kSyntax,
               .text = fmt::format("--page: {} is no address with a port, as 127.0.0.1:8080",
                                   options.address)};
}

/// A page that cannot be had, for want of memory, is missed; the survey goes on.
template <class Work>
void Safely(Work work) {
  try {
    work();
  } catch (const std::exception&) {
  }
}

}  // namespace

SurveyPage::SurveyPage(const JobFile& job, std::string url, fs::path folder)
    : job_(job), url_(std::move(url)), folder_(std::move(folder)), feed_(NowUs()) {}

std::optional<Fault> SurveyPage::ReadKey(const std::string& path) {
  if (path.empty()) return std::nullopt;
  Result<PrivateKey> key = ReadPrivateKey(path);
  if (!key) return key.fault();
  const bool listed = std::ranges::any_of(
      job_.operations.keys, [&key](const OperatorKey& k) { return k.key == PublicKeyOf(*key); });
  if (!listed) {
    return Fault{.code = FaultCode::kConflict,
                 .text = "--page-key: the job lists no [[operator]] with this key",
                 .source = path};
  }
  key_ = std::move(*key);
  return std::nullopt;
}

Result<std::unique_ptr<SurveyPage>> SurveyPage::Open(const SurveyPageOptions& options,
                                                     const JobFile& job, const std::string& url,
                                                     const fs::path& folder) {
  const Result<PageAddress> address = AddressBy(options);
  if (!address) return address.fault();
  std::unique_ptr<SurveyPage> page(new SurveyPage(job, url, folder));
  if (auto fault = page->ReadKey(options.key)) return *std::move(fault);
  // Others on this machine may look, but not give orders under somebody's key.
  if (!address->loopback || page->key_ || !options.token_file.empty()) {
    Result<std::string> token = TokenBy(options);
    if (!token) return token.fault();
    page->token_ = *std::move(token);
  }
  Result<std::optional<OtherWell>> plan = PlanIn(options.plan);
  if (!plan) return plan.fault();
  if (options.sigma_deg > 0) {
    page->feed_.Ask({.sigma_azimuth = FromDegrees(options.sigma_deg),
                     .gyro = job.job.noise,
                     .latitude = job.job.well.latitude});
  }
  PageService service{.token = page->token_};
  const Job& of = job.job;
  Result<std::string> html =
      LivePage({of.well.name, of.identity, *std::move(plan), page->key_.has_value()});
  if (!html) return html.fault();
  service.html = *std::move(html);
  if (page->key_) {
    service.order = [to = page.get()](const OrderField& field) { return to->Order(field); };
  }
  auto server = PageServer::Open(*address, std::move(service), page->feed_);
  if (!server) return server.fault();
  page->server_ = std::move(*server);
  page->address_ = *address;
  page->publisher_ = std::thread([to = page.get()] { to->Publish(); });
  page->watcher_ = std::thread([to = page.get()] { to->Watch(); });
  return page;
}

SurveyPage::~SurveyPage() {
  if (server_) End("stopped", "");
}

std::string SurveyPage::Address() const {
  const bool v6 = address_.host.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}/{}{}", v6 ? "[" : "", address_.host, v6 ? "]" : "",
                     server_->port(), token_.empty() ? "" : "?token=", token_);
}

template <class Change>
void SurveyPage::PutIn(Change change) {
  const std::lock_guard lock(mutex_);
  change(inbox_);
  woken_.notify_all();
}

void SurveyPage::Put(const Station& station) {
  PutIn([&station](Inbox& inbox) { inbox.stations.push_back(station); });
}
void SurveyPage::Put(const Glance& glance) {
  PutIn([&glance](Inbox& inbox) { inbox.glance = glance; });
}
void SurveyPage::Put(const Status& status) {
  PutIn([&status](Inbox& inbox) { inbox.status = status; });
}
void SurveyPage::Put(const Advice& advice) {
  PutIn([&advice](Inbox& inbox) { inbox.advice = advice; });
}

void SurveyPage::Say(std::string_view sentence) {
  PutIn([sentence](Inbox& inbox) {
    if (inbox.notices.size() == LiveFeed::kNoticesKept) inbox.notices.pop_front();
    inbox.notices.emplace_back(NowUs(), std::string(sentence));
  });
}

void SurveyPage::Post(Inbox inbox) {
  for (const Station& station : inbox.stations) feed_.Put(station);
  for (const auto& [utc_us, sentence] : inbox.notices) feed_.Say(sentence, utc_us);
  if (inbox.status) feed_.Put(*inbox.status);
  if (inbox.glance) feed_.Put(*inbox.glance);
  if (inbox.advice) feed_.Put(*inbox.advice);
  feed_.Publish();
}

/// Waits so long; false: the page ends.
bool SurveyPage::Sleep(std::int64_t us) {
  std::unique_lock lock(mutex_);
  woken_.wait_for(lock, std::chrono::microseconds(us), [this] { return ending_; });
  return !ending_;
}

void SurveyPage::Publish() {
  const auto has = [this] {
    return inbox_.glance || inbox_.status || inbox_.advice || !inbox_.stations.empty() ||
           !inbox_.notices.empty();
  };
  bool more = true;
  while (more) {
    Inbox inbox;
    {
      std::unique_lock lock(mutex_);
      woken_.wait(lock, [&] { return ending_ || has(); });
      more = !ending_;
      inbox = std::exchange(inbox_, {});
    }
    Safely([&] { Post(std::move(inbox)); });
    Sleep(kTogetherUs);
  }
}

void SurveyPage::Watch() {
  std::int64_t pause_us = kLookUs;
  while (Sleep(pause_us)) {
    // Nobody looks: nothing is read.
    if (server_->readers() == 0) continue;
    const std::int64_t begin_us = UsedUs();
    Safely([this] { Look(); });
    pause_us = std::max(kLookUs, kLookShare * (UsedUs() - begin_us));
  }
}

/// What changed in the folder. Files that are being exchanged may contradict each other for a
/// moment: the next look finds them whole.
void SurveyPage::Look() {
  for (const auto& [part, folder] : PartsOf(folder_)) {
    std::error_code error;
    const auto time = fs::last_write_time(folder / "run.toml", error);
    const auto seen = seen_.find(folder);
    if (error || (seen != seen_.end() && seen->second == time)) continue;
    const Result<ResultTexts> texts = ReadResultTexts(folder);
    if (!texts) continue;
    const Result<std::string> document = SurveyJson(*texts);
    if (!document || feed_.PutDocument(part, *document)) continue;
    seen_[folder] = time;
    feed_.Publish();
  }
}

void SurveyPage::End(std::string_view how, std::string_view verdict) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(ending_, true)) return;
    woken_.notify_all();
  }
  publisher_.join();
  watcher_.join();
  Safely([&] {
    Look();
    feed_.PutEnd(how, verdict);
  });
  server_.reset();
}

std::string SurveyPage::Order(const OrderField& field) {
  apps::Order order;
  order.what = field("what");
  order.who = field("who");
  order.text = field("text");
  const std::string md = field("md_m");
  double depth = 0;
  if (!Read(md, depth) || !Read(field("run"), order.run) || order.run < 0) {
    return "Not sent: MD and run are numbers.";
  }
  if (!md.empty()) order.md = depth;
  const bool known = order.what == "adjust" || order.what == "accept" || order.what == "reject" ||
                     order.what == "remark";
  if (!known) return "Not sent: the page sends adjust, accept, reject and remark.";
  if (order.what == "remark" && order.text.empty()) return "Not sent: a remark needs its text.";
  const std::unique_lock one(order_mutex_, std::try_to_lock);
  if (!one) return "Not sent: another order is on its way.";
  Result<LiveBus> bus = LiveBus::Open(url_);
  if (!bus) return "Not sent: " + bus.fault().text;
  try {
    const auto sent = SendOrder(*bus, order, job_, key_, [](const SentOrder&) {});
    if (!sent) return "Not sent: " + sent.fault().text;
    const std::string name =
        fmt::format("{} as session {}, number {}", order.what, sent->session, sent->id);
    if (sent->obeyed) return fmt::format("The survey has obeyed: {}.", name);
    return fmt::format("Sent {}; the survey has not said that it obeyed: see below.", name);
  } catch (const std::exception& error) {
    return fmt::format("Not sent: {}.", error.what());
  }
}

}  // namespace wellgyro::apps
