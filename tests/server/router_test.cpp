#include "router.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coppice/system/file.h"
#include "temporary_folder.h"
#include "token.h"

namespace coppice::server {
namespace {

constexpr std::uint16_t kPort = 4000;

class RouterTest : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        page_ = folder_ / "page";
        work_ = folder_ / "work";
        std::filesystem::create_directories(page_);
        std::filesystem::create_directories(work_);
        for (const char* name : {"index.html", "app.js", "app.css", "worker.js"})
            write_file(page_ / name, std::string("<") + name + " __NONCE__>");
        StudioOptions options;
        options.scene.folder = work_;
        options.scene.sandbox = sandbox_ = std::make_shared<const FolderSandbox>(work_);
        engine_ = std::make_unique<StudioEngine>(options);
        Rules rules{.port = kPort, .token = token_, .max_upload = 1000};
        router_ = std::make_unique<Router>(rules, Page(page_), sandbox_, *engine_);
    }

    /// A request as the page sends it.
    HttpHead head(const char* method, const char* target) const {
        HttpHead out{.method = method, .target = target, .fields = {}};
        out.fields.emplace_back("host", "127.0.0.1:4000");
        out.fields.emplace_back("origin", "http://127.0.0.1:4000");
        out.fields.emplace_back("authorization", "Bearer " + token_);
        return out;
    }
    static void set(HttpHead& head, const std::string& name, const std::string& value) {
        without(head, name);
        head.fields.emplace_back(name, value);
    }
    static void without(HttpHead& head, const std::string& name) {
        std::erase_if(head.fields, [&](const auto& field) { return field.first == name; });
    }
    /// Returns the status of an answer, or 0 if there is more to do.
    int status(const HttpHead& head) const {
        const Plan plan = router_->plan(head);
        const auto* reply = std::get_if<HttpReply>(&plan);
        return reply == nullptr ? 0 : reply->status;
    }

    std::filesystem::path page_, work_;
    std::string token_ = make_token();
    std::shared_ptr<const FolderSandbox> sandbox_;
    std::unique_ptr<StudioEngine> engine_;
    std::unique_ptr<Router> router_;
};

TEST_F(RouterTest, SendsThePageWithANewNonce) {
    HttpHead request = head("GET", "/");
    without(request, "authorization");  // the page itself is not secret
    const auto body = [&](const Plan& plan) { return std::get<std::string>(std::get<HttpReply>(plan).body); };
    const std::string first = body(router_->plan(request)), second = body(router_->plan(request));
    EXPECT_TRUE(first.starts_with("<index.html ")) << first;
    EXPECT_EQ(first.find("__NONCE__"), first.npos);
    EXPECT_NE(first, second);
    const HttpReply reply = std::get<HttpReply>(router_->plan(request));
    const auto policy = std::ranges::find(reply.fields, "Content-Security-Policy",
                                          &std::pair<std::string, std::string>::first);
    ASSERT_NE(policy, reply.fields.end());
    EXPECT_NE(policy->second.find("default-src 'none'"), std::string::npos);
    const std::string nonce = std::get<std::string>(reply.body).substr(12, 43);
    EXPECT_NE(policy->second.find("'nonce-" + nonce + "'"), std::string::npos);
}

TEST_F(RouterTest, RejectsOtherHostNames) {
    for (const char* host :
         {"127.0.0.1", "127.0.0.1:4001", "evil.example:4000", "127.0.0.1:4000.evil.example", "LOCALHOST:4000",
          "[::1]:4000", "0.0.0.0:4000", "127.1:4000", "127.0.0.1:4000 ", ""}) {
        for (const char* target : {"/", "/app.js", "/blob/x", "/file/x", "/ws"}) {
            HttpHead request = head("GET", target);
            set(request, "host", host);
            EXPECT_EQ(status(request), 421) << host << " " << target;
        }
    }
    HttpHead none = head("GET", "/");
    without(none, "host");
    EXPECT_EQ(status(none), 421);
    HttpHead twice = head("GET", "/");
    twice.fields.emplace_back("host", "127.0.0.1:4000");
    EXPECT_EQ(status(twice), 421);
    HttpHead other = head("GET", "/");
    set(other, "host", "localhost:4000");
    EXPECT_EQ(status(other), 200);
}

TEST_F(RouterTest, ReturnsOnlyTheFilesOfThePage) {
    for (const char* target : {"/index.htm", "/app.js/", "//app.js", "/./app.js", "/../app.js", "/%61pp.js",
                               "/APP.JS", "/web/app.js", "/etc/passwd", "/favicon.ico", "/app.js.map"})
        EXPECT_EQ(status(head("GET", target)), 404) << target;
    for (const char* target : {"/app.js?x", "/app.js#x", "http://127.0.0.1:4000/", "*", "", "app.js", "/a b",
                               "/\x7f", "/\xc3\xa9"})
        EXPECT_EQ(status(head("GET", target)), 400) << target;
    EXPECT_EQ(status(head("GET", ("/" + std::string(5000, 'a')).c_str())), 400);
    for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS", "TRACE", "CONNECT", "get"})
        EXPECT_EQ(status(head(method, "/app.js")), 405) << method;
}

TEST_F(RouterTest, GeometryAndFilesRequireTheToken) {
    for (const char* target : {"/blob/made-1", "/file/a.swc"}) {
        EXPECT_EQ(status(head("GET", target)), 0) << target;
        HttpHead request = head("GET", target);
        without(request, "authorization");
        EXPECT_EQ(status(request), 401) << target;
        const std::string changed = (token_[0] == 'A' ? "B" : "A") + token_.substr(1);
        const std::vector<std::string> wrong{"Bearer",
                                             "Bearer ",
                                             "Bearer x",
                                             "bearer " + token_,
                                             "Bearer " + token_ + "x",
                                             "Bearer " + token_.substr(1),
                                             "Bearer  " + token_,
                                             "Basic " + token_,
                                             "Bearer " + changed,
                                             token_};
        for (const std::string& header : wrong) {
            set(request, "authorization", header);
            EXPECT_EQ(status(request), 401) << header;
        }
    }
}

TEST_F(RouterTest, AcceptsConnectionsOfItsOwnPageOnly) {
    HttpHead request = head("GET", "/ws");
    EXPECT_EQ(status(request), 426);
    set(request, "upgrade", "WebSocket");
    EXPECT_TRUE(std::holds_alternative<OpenSocket>(router_->plan(request)));
    for (const char* origin :
         {"http://evil.example", "http://127.0.0.1:4001", "https://127.0.0.1:4000", "null", "",
          "http://127.0.0.1:4000/", "http://localhost:4000", "http://127.0.0.1:4000.evil.example"}) {
        set(request, "origin", origin);
        EXPECT_EQ(status(request), 403) << origin;
    }
    without(request, "origin");
    EXPECT_EQ(status(request), 403);
    HttpHead other = head("POST", "/ws");
    set(other, "upgrade", "websocket");
    EXPECT_EQ(status(other), 405);
}

TEST_F(RouterTest, AcceptsUploadsWithALength) {
    HttpHead request = head("PUT", "/file/a%20b/c.swc");
    EXPECT_EQ(status(request), 411);
    set(request, "content-length", "12");
    const Plan plan = router_->plan(request);
    ASSERT_TRUE(std::holds_alternative<TakeFile>(plan));
    EXPECT_EQ(std::get<TakeFile>(plan).name, "a b/c.swc");
    EXPECT_EQ(std::get<TakeFile>(plan).bytes, 12u);
    for (const char* length : {"-1", "1e3", "", " 1", "0x10", "99999999999999999999", "12,12"}) {
        set(request, "content-length", length);
        EXPECT_EQ(status(request), 400) << length;
    }
    set(request, "content-length", "1001");
    EXPECT_EQ(status(request), 413);
    set(request, "content-length", "12");
    set(request, "transfer-encoding", "chunked");
    EXPECT_EQ(status(request), 411);
    without(request, "transfer-encoding");
    set(request, "origin", "http://evil.example");
    EXPECT_EQ(status(request), 403);
    EXPECT_EQ(status(head("DELETE", "/file/a.swc")), 405);
    EXPECT_EQ(status(head("POST", "/file/a.swc")), 405);
    EXPECT_EQ(status(head("GET", "/file/")), 400);
    EXPECT_EQ(status(head("GET", "/file/%zz")), 400);
    EXPECT_EQ(status(head("GET", "/file/%4")), 400);
}

TEST_F(RouterTest, RejectsABodyInRequestsWithoutOne) {
    for (const char* target : {"/", "/blob/x", "/file/x", "/ws"}) {
        HttpHead request = head("GET", target);
        set(request, "upgrade", "websocket");
        set(request, "content-length", "5");
        EXPECT_EQ(status(request), 400) << target;
        without(request, "content-length");
        set(request, "transfer-encoding", "chunked");
        EXPECT_EQ(status(request), 400) << target;
    }
}

TEST_F(RouterTest, ReturnsOnlyFilesOfTheFolder) {
    write_file(work_ / "a.swc", "a");
    std::filesystem::create_symlink("/etc/passwd", work_ / "link");
    EXPECT_EQ(router_->file({"a.swc"}).status, 200);
    for (const char* name :
         {"../a.swc", "/etc/passwd", "link", ".hidden", "missing", ".", "", "a.swc/", "a\nb"})
        EXPECT_EQ(router_->file({name}).status, 404) << name;
}

TEST_F(RouterTest, UploadsAreCreatedWhole) {
    {
        Router::Upload cut(*router_, {.name = "cut.swc", .bytes = 9});
        cut.write("half");
    }
    EXPECT_FALSE(std::filesystem::exists(work_ / "cut.swc"));
    Router::Upload whole(*router_, {.name = "whole.swc", .bytes = 4});
    whole.write("wh");
    whole.write("le");
    const HttpReply reply = whole.commit();
    EXPECT_EQ(nlohmann::json::parse(std::get<std::string>(reply.body)),
              (nlohmann::json{{"file", "whole.swc"}, {"bytes", 4}}));
    EXPECT_EQ(read_file(work_ / "whole.swc"), "whle");
    EXPECT_THROW(Router::Upload(*router_, {.name = "whole.swc"}), Router::Exists);
    EXPECT_NO_THROW(Router::Upload(*router_, {.name = "whole.swc", .bytes = 0, .overwrite = true}));
    EXPECT_EQ(read_file(work_ / "whole.swc"), "whle");
    EXPECT_THROW(Router::Upload(*router_, {.name = "../out.swc"}), IoError);
    EXPECT_THROW(Router::Upload(*router_, {.name = "none/out.swc"}), IoError);
}

TEST(Token, Has256BitsInUrlSafeCharacters) {
    const std::string a = make_token(), b = make_token();
    EXPECT_EQ(a.size(), 43u);  // 256 bits by 6, rounded up
    EXPECT_NE(a, b);
    EXPECT_EQ(a.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
              a.npos);
    EXPECT_TRUE(same_token(a, a));
    EXPECT_FALSE(same_token(a, b));
    EXPECT_FALSE(same_token(a + "x", a));
    EXPECT_FALSE(same_token(a.substr(1), a));
    EXPECT_FALSE(same_token("", a));
}

TEST(Http, DecodesPercentEscapes) {
    EXPECT_EQ(percent_decoded("a%20b%2fc%C3%A9"), "a b/c\xc3\xa9");
    EXPECT_EQ(percent_decoded("%00"), std::string(1, '\0'));
    for (const char* wrong : {"%", "%1", "%g0", "%0g", "a%"}) EXPECT_FALSE(percent_decoded(wrong)) << wrong;
}

}  // namespace
}  // namespace coppice::server
