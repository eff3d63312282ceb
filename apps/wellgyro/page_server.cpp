#include "page_server.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <httplib.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace wellgyro::apps {
namespace {

using std::chrono::milliseconds;

constexpr int kPatienceS = 2;                     // with who does not send or take
constexpr Duration kBeat = Duration::Seconds(1);  // so often a reader hears that the link is there
constexpr milliseconds kFarewell{2000};
constexpr std::size_t kBodyMost = 8192;
constexpr int kNice = 5;  // the survey goes first

/// Threads for connections, made as they are needed. Where all are busy no connection is taken,
/// which waits in the system's own short queue then: neither memory nor descriptors run out.
class Workers : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return closing_ || open_ < kMost; });
    ++open_;
    tasks_.push_back(std::move(task));
    if (idle_ < tasks_.size() && threads_.size() < kMost) AddOne();
    woken_.notify_one();
  }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    woken_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  /// Lets a connection in that waits for room, so that the server sees that it is to end.
  void Release() {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    room_.notify_all();
  }

 private:
  static constexpr std::size_t kMost = PageServer::kReaders + PageServer::kOthers;

  void AddOne() {
    try {
      threads_.emplace_back([this] { Work(); });
    } catch (const std::system_error&) {
      // The system has no more threads: the connection waits for one of those that are there.
    }
  }

  void Work() {
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
    std::unique_lock lock(mutex_);
    for (;;) {
      ++idle_;
      woken_.wait(lock, [this] { return closing_ || !tasks_.empty(); });
      --idle_;
      if (tasks_.empty()) return;
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      try {
        task();
      } catch (...) {
        // Whatever a connection does, it is not the survey's.
      }
      lock.lock();
      --open_;
      room_.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable woken_, room_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::thread> threads_;
  std::size_t idle_ = 0, open_ = 0;
  bool closing_ = false;
};

std::string OwnName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data())
                                                          : std::string();
}

/// The value of a cookie, as "a=1; b=2" has it.
std::string CookieOf(const httplib::Request& request, const std::string& name) {
  const std::string all = "; " + request.get_header_value("Cookie");
  const std::size_t at = all.find("; " + name + "=");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 3;
  return all.substr(begin, all.find(';', begin) - begin);
}

void Say(httplib::Response& response, int status, const std::string& sentence) {
  response.status = status;
  response.set_content(sentence + "\n", "text/plain; charset=utf-8");
}

}  // namespace

struct PageServer::Core {
  Core(PageAddress the_address, PageService the_service, LiveFeed& the_feed)
      : address(std::move(the_address)), service(std::move(the_service)), feed(the_feed) {}

  bool Begin();
  void End();
  void Settle();
  bool LetIn(const httplib::Request& request, httplib::Response& response) const;
  void GivePage(const httplib::Request& request, httplib::Response& response) const;
  void GiveEvents(const httplib::Request& request, httplib::Response& response);
  void TakeOrder(const httplib::Request& request, httplib::Response& response) const;
  bool IsOwn(const httplib::Request& request) const;
  std::string Cookie() const { return fmt::format("wellgyro-{}", address.port); }

  PageAddress address;
  const PageService service;
  LiveFeed& feed;
  const std::string own_name = OwnName();
  std::atomic<int> readers = 0;
  std::unique_ptr<Workers> made = std::make_unique<Workers>();
  Workers* const workers = made.get();  ///< the server's, which deletes it
  httplib::Server server;
  std::atomic<bool> left = false;  ///< by the listener
  std::thread listener;
};

void PageServer::Core::Settle() {
  // httplib's own choice would let two programs share a port, each with half of the readers.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.new_task_queue = [this] { return made.release(); };
  server.set_read_timeout(kPatienceS);
  server.set_write_timeout(kPatienceS);
  server.set_keep_alive_max_count(1);  // a connection that waits for more would hold up the end
  server.set_payload_max_length(kBodyMost);
  server.set_tcp_nodelay(true);
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"Referrer-Policy", "no-referrer"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "DENY"},
                              {"Cross-Origin-Resource-Policy", "same-origin"}});
  using Next = httplib::Server::HandlerResponse;
  server.set_pre_routing_handler([this](const auto& request, auto& response) {
    return LetIn(request, response) ? Next::Unhandled : Next::Handled;
  });
  server.Get("/", [this](const auto& request, auto& response) { GivePage(request, response); });
  server.Get("/events",
             [this](const auto& request, auto& response) { GiveEvents(request, response); });
  server.Post("/order",
              [this](const auto& request, auto& response) { TakeOrder(request, response); });
}

bool PageServer::Core::Begin() {
  Settle();
  if (address.port == 0) {
    address.port = server.bind_to_any_port(address.host);
    if (address.port <= 0) return false;
  } else if (!server.bind_to_port(address.host, address.port)) {
    return false;
  }
  // Bound is as good as listening: who comes now waits in the system's queue.
  listener = std::thread([this] {
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
    server.listen_after_bind();
    left = true;
  });
  return true;
}

void PageServer::Core::End() {
  feed.Close();
  for (milliseconds waited{0}; readers > 0 && waited < kFarewell; waited += milliseconds(10)) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  // What does not run yet cannot be stopped.
  while (!server.is_running() && !left) std::this_thread::sleep_for(milliseconds(1));
  if (!left) workers->Release();
  server.stop();
  listener.join();
}

bool PageServer::Core::LetIn(const httplib::Request& request, httplib::Response& response) const {
  if (!MayName(request.get_header_value("Host"), address, own_name)) {
    Say(response, 421, "This machine does not go by that name.");
    return false;
  }
  if (service.token.empty()) return true;
  if (request.method == "GET" && request.path == "/" && request.has_param("token")) {
    if (SameToken(request.get_param_value("token"), service.token)) {
      response.set_header("Set-Cookie", fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict",
                                                    Cookie(), service.token));
      response.set_redirect("/", 303);
      return false;
    }
  } else if (SameToken(CookieOf(request, Cookie()), service.token)) {
    return true;
  }
  Say(response, 403, "The page wants its token: open the address that the survey said.");
  return false;
}

void PageServer::Core::GivePage(const httplib::Request& /*request*/,
                                httplib::Response& response) const {
  // By a provider, as a body would be copied, and compressed anew for each who asks.
  response.set_content_provider(service.html.size(), "text/html; charset=utf-8",
                                [this](std::size_t at, std::size_t size, httplib::DataSink& sink) {
                                  return sink.write(service.html.data() + at, size);
                                });
}

void PageServer::Core::GiveEvents(const httplib::Request& request, httplib::Response& response) {
  if (readers.fetch_add(1) >= kReaders) {
    --readers;
    return Say(response, 503, "Too many pages are open.");
  }
  std::string after = request.get_header_value("Last-Event-ID");
  if (after.empty()) after = request.get_param_value("after");
  auto place = std::make_shared<LiveFeed::Place>(feed.PlaceOf(after));
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, place](std::size_t at, httplib::DataSink& sink) {
        // The first words go out at once, so that the page knows its link.
        std::string text = at == 0 ? feed.Hello() : feed.After(*place, kBeat);
        if (text.empty() && feed.closed()) {
          sink.done();
          return true;
        }
        if (text.empty()) text = "event: beat\ndata: null\n\n";
        return sink.write(text.data(), text.size());
      },
      [this](bool) { --readers; });
}

/// Asked by the page itself: a stranger's page can set no such header, nor this origin.
bool PageServer::Core::IsOwn(const httplib::Request& request) const {
  return request.get_header_value("X-Wellgyro") == "order" &&
         request.get_header_value("Origin") == "http://" + request.get_header_value("Host");
}

void PageServer::Core::TakeOrder(const httplib::Request& request,
                                 httplib::Response& response) const {
  if (!service.order) return Say(response, 404, "This page takes no orders.");
  if (!IsOwn(request)) return Say(response, 403, "Orders are taken from the page itself alone.");
  Say(response, 200,
      service.order([&request](const char* name) { return request.get_param_value(name); }));
}

PageServer::PageServer(std::unique_ptr<Core> core) : core_(std::move(core)) {}
PageServer::~PageServer() { core_->End(); }
int PageServer::port() const { return core_->address.port; }
int PageServer::readers() const { return core_->readers; }

Result<std::unique_ptr<PageServer>> PageServer::Open(const PageAddress& address,
                                                     PageService service, LiveFeed& feed) {
  auto core = std::make_unique<Core>(address, std::move(service), feed);
  if (!core->Begin()) {
    return Fault{.code = FaultCode::kIo,
                 .text = fmt::format("--page: {}:{} cannot be had: it is taken, or not this "
                                     "machine's",
                                     address.host, address.port)};
  }
  return std::unique_ptr<PageServer>(new PageServer(std::move(core)));
}

}  // namespace wellgyro::apps
