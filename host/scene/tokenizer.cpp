#include "scene/tokenizer.h"

#include "base/read_file.h"

namespace tristim {

Tokenizer::Tokenizer(const std::string& path)
    : path_(std::make_shared<const std::string>(path)), source_(read_whole_file(path)) {}

void Tokenizer::skip_blank() {
    while (position_ < source_.size()) {
        const char c = source_[position_];
        if (c == '#') {
            while (position_ < source_.size() && source_[position_] != '\n')
                ++position_;
        } else if (c == '\n') {
            ++line_;
            ++position_;
        } else if (c == ' ' || c == '\t' || c == '\r') {
            ++position_;
        } else {
            return;
        }
    }
}

std::string Tokenizer::read_string(const SourceLocation& where) {
    std::string text;
    for (++position_; position_ < source_.size(); ++position_) {
        char c = source_[position_];
        if (c == '"') {
            ++position_;
            return text;
        }
        if (c == '\n')
            break;
        if (c == '\\') {
            if (++position_ == source_.size())
                break;
            switch (source_[position_]) {
            case 'b':
                c = '\b';
                break;
            case 'f':
                c = '\f';
                break;
            case 'n':
                c = '\n';
                break;
            case 'r':
                c = '\r';
                break;
            case 't':
                c = '\t';
                break;
            case '\\':
                c = '\\';
                break;
            case '\'':
                c = '\'';
                break;
            case '"':
                c = '"';
                break;
            default:
                fail_at(where, "unknown escape \"\\{}\" in a string", source_[position_]);
            }
        }
        text += c;
    }
    fail_at(where, "the string \"{}\" has no closing quote", text);
}

Token Tokenizer::next() {
    skip_blank();
    Token token;
    token.where = {path_, line_};
    if (position_ >= source_.size())
        return token;
    const char c = source_[position_];
    if (c == '"') {
        token.kind = Token::Kind::String;
        token.text = read_string(token.where);
    } else if (c == '[' || c == ']') {
        token.kind = c == '[' ? Token::Kind::OpenBracket : Token::Kind::CloseBracket;
        token.text = c;
        ++position_;
    } else {
        const std::size_t end = source_.find_first_of(" \t\r\n\"[]#", position_);
        token.kind = Token::Kind::Word;
        token.text = source_.substr(position_, end - position_);
        position_ = end == std::string::npos ? source_.size() : end;
    }
    return token;
}

} // namespace tristim
